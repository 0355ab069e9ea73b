#include "cli/model_options.h"

#include "cli/add_option.h"
#include "cli/arguments.h"
#include "cli/daylight_options.h"
#include "cli/parse_value.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight::cli {
namespace {

// The formats that can be read, as one word or list.
std::string formats(const std::string& separator) {
  std::string list;
  for (const std::string& format : readable_formats()) list += (list.empty() ? "" : separator) + format;
  return list;
}

void add_choice_options(CLI::App& command, ModelOptions& options) {
  command.option_defaults()->group("The model");
  command
      .add_option("--only", options.only,
                  "only faces of objects, groups or materials of this name take\npart (* and ? stand for any letters: "
                  "'IfcWall*'); may be\nrepeated; default: all")
      ->allow_extra_args(false)
      ->option_text("NAME");
  command
      .add_option("--exclude", options.leave_out,
                  "faces of objects, groups or materials of this name do not take\npart; may be repeated; default: all "
                  "do")
      ->allow_extra_args(false)
      ->option_text("NAME");
  add(command, "--simplify", "LENGTH",
      "bodies that are smaller, as 5cm, are left out, and those that\ndiffer by less from a box become boxes; a note "
      "tells "
      "what went;\ndefault: all stay",
      [&options](const std::string& text) { options.detail = length("--simplify", text); });
  add(command, "--maintenance-factor", "NUMBER",
      "the share of their light when new that lamps and luminaires give,\nas 0.8 or 80%; daylight is not changed; "
      "default: what the scene\nfile says, else 1",
      [&options](const std::string& text) {
        options.maintenance_factor = text.ends_with('%')
                                         ? share("--maintenance-factor", text)
                                         : number("--maintenance-factor", text, "a number above 0 and up to 1, as 0.8",
                                                  [](double x) { return x > 0 && x <= 1; });
        if (*options.maintenance_factor > 1) throw refusal("--maintenance-factor", text, "at most 100%");
      });
  add(command, "--bands", "N|rgb|auto",
      "spectral bands of equal widths from 380 to 780 nm, or linear\nRGB, whatever has a spectrum; default: as the "
      "scene file says,\nelse auto: RGB where nothing has a spectrum, or as many as\n--color-error needs",
      [&options](const std::string& text) { options.bands = text; });
  add(command, "--color-error", "DE", "how far colours may be off by the number of bands, CIE dE00;\ndefault 1",
      [&options](const std::string& text) {
        options.color_error =
            number("--color-error", text, "a colour difference above 0", [](double value) { return value > 0; });
      });
  command.add_flag("--no-merge", options.keep_faces,
                   "faces stay as the file has them; default: those of one object\nand material that lie in one plane "
                   "and share edges become one");
}

// What --bands and --color-error ask for, if they do.
std::optional<BandsAsked> bands_asked(const ModelOptions& options) {
  if (options.bands.empty() && !options.color_error) return std::nullopt;
  BandsAsked asked;
  if (options.color_error) asked.color_error = *options.color_error;
  if (options.bands.empty() || options.bands == "auto") return asked;
  const std::string expected = "a number of bands from 1 to 400, rgb or auto";
  if (options.color_error) throw refusal("--bands", options.bands, "auto, or no --color-error beside it");
  asked.rgb = options.bands == "rgb";
  if (asked.rgb) return asked;
  const std::optional<double> bands = to_number(options.bands);
  if (!bands || !is_number_of_bands(*bands)) throw refusal("--bands", options.bands, expected);
  asked.edges_nm = equal_edges(static_cast<Eigen::Index>(*bands));
  return asked;
}

}  // namespace

void add_file_options(CLI::App& command, ModelOptions& options) {
  command.option_defaults()->group("The model");
  command
      .add_option(
          "MODEL", options.models,
          "the model, or several files that together are one\nscene: " + formats(", ") + "; - is the\nstandard input")
      ->option_text("...");
  command
      .add_option_function<std::string>(
          "--format",
          [&options](const std::string& text) {
            std::vector<std::pair<std::string, std::string>> allowed;
            for (const std::string& format : readable_formats()) allowed.emplace_back(format, format);
            options.format = choice<std::string>("--format", text, allowed);
          },
          "format of the model files; default: from the extension,\nobj for -")
      ->option_text(formats("|"));
  command
      .add_option_function<std::string>(
          "--unit", [&options](const std::string& text) { options.metres_per_unit = unit_length(text); },
          "length of one model unit, instead of what the file states;\ndefault: as the file states, else m")
      ->option_text("m|cm|mm|in|ft");
  add_up_option(command, options.up);
  add(command, "--confine", "FOLDER",
      "reads no file outside of this folder, whatever the model names\nand wherever links lead; default: any file",
      [&options](const std::string& text) {
        if (text.empty()) throw refusal("--confine", text, "the name of a folder");
        options.confine = text;
      });
}

void add_model_options(CLI::App& command, ModelOptions& options) {
  add_file_options(command, options);
  add_set_option(command, options.settings);
  add_choice_options(command, options);
  add_daylight_options(command, options.daylight);
}

void add_up_option(CLI::App& command, std::optional<Vector>& up) {
  command.option_defaults()->group("The model");
  add(command, "--up", "y|z",
      "the model's upright axis: where down is for lamps, sky and\npictures; default: as the format says (y: glTF; z: "
      "IFC, gbXML,\nRadiance), else that across which most area lies, or against the\nlamps' light",
      [&up](const std::string& text) {
        up = choice<Vector>("--up", text, {{"y", Vector::UnitY()}, {"z", Vector::UnitZ()}});
      });
}

void add_set_option(CLI::App& command, std::vector<std::string>& settings) {
  command.option_defaults()->group("The model");
  command
      .add_option("--set", settings,
                  "changes a material (* and ? in its name stand for any\nletters): reflectance (diffuse), "
                  "specular_reflectance (as "
                  "of a\nmirror), transmittance (straight) or diffuse_transmittance (of\na translucent sheet; 0 to 1), "
                  "exitance (W/m^2), radiance\n(W/(m^2 sr)) or index (of refraction, 1 or more, one value;\n1: a "
                  "sheet with holes, the same at all angles); may be\nrepeated; default: as in the model")
      ->allow_extra_args(false)
      ->option_text("MATERIAL.QUANTITY=R,G,B");
}

std::vector<std::filesystem::path> model_files(const ModelOptions& options) {
  for (auto model = options.models.begin(); model != options.models.end(); ++model) {
    if (std::find(options.models.begin(), model, *model) == model) continue;
    throw UsageError("MODEL: found '" + *model + "' twice; expected every model once");
  }
  return {options.models.begin(), options.models.end()};
}

ReadOptions read_options(const ModelOptions& options) {
  ReadOptions read;
  read.metres_per_unit = options.metres_per_unit;
  read.format = options.format;
  read.up = options.up;
  read.confine = options.confine;
  read.only = options.only;
  read.leave_out = options.leave_out;
  read.detail = options.detail;
  read.maintenance_factor = options.maintenance_factor;
  read.keep_faces = options.keep_faces;
  read.daylight = options.daylight;
  read.settings = material_settings(options.settings);
  read.bands = bands_asked(options);
  return read;
}

std::vector<MaterialSetting> material_settings(const std::vector<std::string>& texts) {
  std::vector<MaterialSetting> settings;
  for (const std::string& text : texts) settings.push_back(parse_material_setting(text));
  return settings;
}

}  // namespace patchlight::cli
