#include "cli/solution_options.h"

#include "patchlight/output/write_result.h"

#include "cli/add_option.h"
#include "cli/lightmap_options.h"
#include "cli/mesh_options.h"
#include "cli/page_option.h"
#include "cli/parse_value.h"
#include "output/vtk/write_points.h"

#include <algorithm>
#include <utility>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

// Adds an option that holds the name of a file.
void add_file(CLI::App& command, const std::string& name, std::string& file, const std::string& help) {
  const std::string option = name.substr(name.rfind(',') + 1);
  add(command, name, "FILE", help, [&file, option](const std::string& text) {
    if (text.empty()) throw UsageError(option + ": found an empty name; expected the name of a file");
    file = text;
  });
}

void require_extension(const std::string& option, const std::string& file, const std::vector<std::string>& allowed) {
  std::string words;
  for (const std::string& extension : allowed) {
    if (path(file).extension() == extension) return;
    words += (words.empty() ? "" : " or ") + extension;
  }
  throw UsageError(option + ": found '" + file + "'; expected a name that ends in " + words);
}

// Sensors may be asked for by --points, by a scene file among the models, or by that of which form factors are kept.
bool may_have_sensors(const SolveArguments& arguments, const SolutionOptions& options) {
  const auto is_scene_file = [](const path& model) {
    return model.extension() == ".toml" || model.extension() == ".hbjson";
  };
  const std::string& format = arguments.read.format;
  return !options.points.empty() || arguments.models.empty() || format == "toml" || format == "hbjson" ||
         std::any_of(arguments.models.begin(), arguments.models.end(), is_scene_file);
}

std::vector<std::string> readings_extensions() {
  std::vector<std::string> all = points_extensions();
  all.insert(all.end(), {".svg", ".png"});
  return all;
}

std::array<double, 2> range_of_map(const std::string& text) {
  const auto any = [](double) { return true; };
  const std::string expected = "two numbers, the lower first, as in 0,500";
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw refusal("--map-range", text, expected);
  const std::array<double, 2> range = {number("--map-range", text.substr(0, comma), expected, any),
                                       number("--map-range", text.substr(comma + 1), expected, any)};
  if (!(range[0] < range[1])) throw refusal("--map-range", text, expected);
  return range;
}

bool is_map(const path& file) { return file.extension() == ".svg" || file.extension() == ".png"; }

void require_consistent(const std::string& command, const SolutionOptions& options) {
  if (options.results.empty() && options.series.empty() && options.picture.file.empty() && options.report.empty() &&
      options.page.empty() && options.lightmap.folder.empty() && options.points.empty() &&
      options.points_outputs.empty()) {
    throw UsageError(command +
                     ": nothing would be written; give at least one of -o, --html, --series, --picture, "
                     "--lightmap, --json, --points");
  }
  if (options.quiet && options.verbose) throw UsageError("--quiet and -v exclude each other; give one of them");
  for (const std::string& result : options.results) require_extension("-o", result, result_extensions());
  for (const std::string& file : options.points_outputs)
    require_extension("--points-output", file, readings_extensions());
  if (!options.series.empty()) require_extension("--series", options.series, {".pvd"});
}

// A folder of form factors holds nothing else, so that it may be replaced as a whole.
void require_untouched_folder(const SolveArguments& arguments) {
  if (arguments.form_factors.empty()) return;
  std::error_code error;
  const path folder = weakly_canonical(arguments.form_factors / ".", error);
  for (const auto& [option, file] : outputs_of(arguments)) {
    if (error || file.empty() || weakly_canonical(absolute(file), error).parent_path() != folder) continue;
    throw UsageError(option + ": '" + file.string() +
                     "' lies in the folder of form factors; expected a file elsewhere");
  }
}

// Named after the file of points, else after the first model.
path default_points_output(const SolveArguments& arguments) {
  const path beside = arguments.results.empty() ? path() : arguments.results.front();
  const path name = !arguments.points.empty()   ? arguments.points
                    : !arguments.models.empty() ? arguments.models.front()
                    : beside.empty()            ? path("sensors")
                                                : beside;
  return beside.parent_path() / (name.stem().string() + ".irradiance.csv");
}

void add_points_options(CLI::App& command, SolutionOptions& options) {
  command.option_defaults()->group("Sensors");
  add_file(command, "--points", options.points,
           "points where irradiance is wanted: lines x y z nx ny nz,\nposition in model units, for a scene file in "
           "metres, and\ndirection of the receiving side");
  command
      .add_option("--points-output", options.points_outputs,
                  "irradiance at these points and at the sensors of a scene file,\nwith error bars (.csv), for "
                  "ParaView (.vtp), or grids as maps\n(.svg, .png); may be repeated; default: the points file's or "
                  "scene's name with "
                  ".irradiance.csv, in\nthe folder of -o, else in the current one")
      ->allow_extra_args(false)
      ->option_text("FILE");
  add(command, "--map", "illuminance|daylight-factor",
      "what maps among these show, with isolines; daylight factors under\nan overcast sky; default illuminance",
      [&options](const std::string& text) {
        options.map.quantity = choice<MapQuantity>(
            "--map", text,
            {{"illuminance", MapQuantity::illuminance}, {"daylight-factor", MapQuantity::daylight_factor}});
        options.map_given = "--map";
      });
  add(command, "--map-range", "LOWER,UPPER", "of the colors of maps; default: from 0 to a round number",
      [&options](const std::string& text) {
        options.map.range = range_of_map(text);
        options.map_given = "--map-range";
      });
}

}  // namespace

void add_output_options(CLI::App& command, SolutionOptions& options) {
  command.option_defaults()->group("Results and pictures");
  command
      .add_option("-o,--output", options.results,
                  "solved patches: for ParaView (.vtp; .vtu for tools that take\nunstructured grids alone), or with "
                  "vertex colors for viewers and\nthe web (.ply, .glb); may be repeated")
      ->allow_extra_args(false)
      ->option_text("FILE");
  add(command, "--ambient-occlusion", "LENGTH",
      "adds to .vtp the share of the hemisphere before each patch in\nwhich nothing lies within this length, as in 2m "
      "(array\nambient_occlusion); default: not found",
      [&options](const std::string& text) { options.ambient_distance = length("--ambient-occlusion", text); });
  add_page_option(command, options.page);
  add_file(command, "--series", options.series,
           "the iterations one by one for ParaView (.pvd); with the Jacobi\nsolver, then the default, iteration k is "
           "bounce k");
  add_file(command, "--json", options.report, "what was asked, decided and found, with energy balance (JSON)");
  add_file(command, "--picture", options.picture.file,
           "a picture of the solution (.png), or its radiances (.hdr, .exr)");
  add_picture_options(command, options.picture, PictureQuality::draft);
  add_lightmap_options(command, options.lightmap);
  add_points_options(command, options);
}

void add_solver_options(CLI::App& command, SolutionOptions& options, Request& request) {
  command.option_defaults()->group("Form factors and equations");
  add_closure_option(command, request);
  add_relaxation_option(command, request.solver.relaxation);
  add(command, "--solver", solver_names("|"),
      "how the equations are solved; default cg, with --series jacobi,\nwith rows of rays gmres",
      [&request, &options](const std::string& text) {
        options.solver_given = true;
        request.solver.solver = solver_named("--solver", text);
      });
  add(command, "--tolerance", "NUMBER",
      "relative error at which the solver stops; default 1e-6, with\n--accuracy what that takes, with rows of rays "
      "0.004 over\nthe root of their number, of 64 rays 5e-4",
      [&request](const std::string& text) {
        const auto inside = [](double x) { return x > 0 && x < 1; };
        request.solver.relative_error = number("--tolerance", text, "a number above 0 and below 1", inside);
      });
  add(command, "--max-iterations", "N", "the solver gives up after so many iterations; default 1000",
      [&request](const std::string& text) {
        request.solver.max_iterations = static_cast<int>(whole_number("--max-iterations", text, 0, 1'000'000'000));
      });
  add(command, "--max-rows", "SHARE",
      "a first picture: progressive or overshooting stops after this\nshare of the rows of form factors, e.g. 5%; "
      "default: no such limit",
      [&request](const std::string& text) { request.solver.max_rows = share("--max-rows", text); });
}

void add_verbosity_options(CLI::App& command, SolutionOptions& options) {
  command.option_defaults()->group("The run");
  command.add_flag("--discard", options.discards,
                   "a signal (Ctrl-C) ends the run without further files;\ndefault: the results so far are written");
  command.add_flag("-q,--quiet", options.quiet, "prints errors and warnings only; default: progress and a summary");
  command.add_flag("-v,--verbose", options.verbose, "adds decisions, counts and speed to the summary; default: off");
}

SolveArguments with_solution(SolveArguments arguments, const std::string& command, const SolutionOptions& options) {
  require_consistent(command, options);
  if (!options.series.empty() && !options.solver_given) arguments.request.solver.solver = Solver::jacobi;
  arguments.results.assign(options.results.begin(), options.results.end());
  arguments.series = options.series;
  arguments.report = options.report;
  arguments.page = options.page;
  arguments.picture = picture_settings(options.picture, "--picture", PictureQuality::draft);
  arguments.lightmap = lightmap_settings(options.lightmap);
  if (arguments.picture.views.size() > 1)
    throw UsageError("--view: found several; expected one, as patchlight render takes pictures of more");
  arguments.points = options.points;
  arguments.points_outputs.assign(options.points_outputs.begin(), options.points_outputs.end());
  if (!options.points.empty() && arguments.points_outputs.empty()) {
    arguments.points_outputs = {default_points_output(arguments)};
  }
  arguments.default_points_output = default_points_output(arguments);
  if (!arguments.points_outputs.empty() && !may_have_sensors(arguments, options)) {
    throw UsageError("--points-output needs --points FILE, or a scene file with sensors");
  }
  const auto is_vtk = [](const path& result) { return result.extension() == ".vtp" || result.extension() == ".vtu"; };
  if (options.ambient_distance && std::none_of(arguments.results.begin(), arguments.results.end(), is_vtk))
    throw UsageError("--ambient-occlusion is written into results for ParaView; expected -o RESULT.vtp");
  arguments.ambient_distance = options.ambient_distance;
  arguments.map = options.map;
  if (!options.map_given.empty() &&
      std::none_of(arguments.points_outputs.begin(), arguments.points_outputs.end(), is_map))
    throw UsageError(options.map_given + " is of maps of sensors; expected --points-output FILE.svg or FILE.png");
  arguments.discards = options.discards;
  arguments.solver_given = options.solver_given;
  if (options.quiet) arguments.verbosity = Verbosity::quiet;
  if (options.verbose) arguments.verbosity = Verbosity::verbose;
  require_distinct(outputs_of(arguments));
  require_outside_lightmap(arguments.lightmap, outputs_of(arguments));
  require_not_read(outputs_of(arguments), given_files(arguments));
  require_untouched_folder(arguments);
  return arguments;
}

std::vector<OutputFile> outputs_of(const SolveArguments& arguments) {
  std::vector<OutputFile> files = {{"--series", arguments.series},
                                   {"--json", arguments.report},
                                   {"--html", arguments.page},
                                   {"--lightmap", arguments.lightmap.folder}};
  for (OutputFile& file : picture_files(arguments.picture, "--picture")) files.push_back(std::move(file));
  for (const path& result : arguments.results) files.push_back({"-o", result});
  for (const path& file : arguments.points_outputs) files.push_back({"--points-output", file});
  return files;
}

std::vector<path> given_files(const SolveArguments& arguments) {
  std::vector<path> files = arguments.models;
  if (!arguments.points.empty()) files.push_back(arguments.points);
  return files;
}

}  // namespace patchlight::cli
