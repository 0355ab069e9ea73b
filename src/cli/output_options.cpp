#include "cli/output_options.h"

#include "patchlight/output/write_result.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "cli/options.h"
#include "output/image/write_image.h"
#include "output/vtk/write_vtk.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <system_error>
#include <utility>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

std::array<int, 2> size_of_picture(const std::string& option, const std::string& text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) throw refusal(option, text, "width and height in pixels, e.g. 1600x900");
  const auto edge = [&](const std::string& part) { return static_cast<int>(whole_number(option, part, 1, 32768)); };
  return {edge(text.substr(0, cross)), edge(text.substr(cross + 1))};
}

// A factor, a signed number of stops, or "each".
Exposure exposure_value(const std::string& option, const std::string& text) {
  if (text == "each") return {.each = true};
  const std::string expected = "a factor above 0, stops with a sign, e.g. +1, or each";
  if (text.starts_with('-') || text.starts_with('+')) {
    const auto few = [](double stops) { return std::abs(stops) <= 100; };
    return {.stops = number(option, text.substr(text[0] == '+' ? 1 : 0), expected, few)};
  }
  return {.factor = number(option, text, expected, [](double factor) { return factor > 0; })};
}

void add_color_options(CLI::App& command, PictureGiven& given) {
  add(command, "--exposure", given.exposure, exposure_value);
  add(command, "--false-color", [&given](const std::string& text) {
    const std::size_t colon = text.find(':');
    given.colors =
        choice<PictureColors>("--false-color", text.substr(0, colon), {{"luminance", PictureColors::luminance}});
    if (colon == std::string::npos) return;
    given.brightest = number("--false-color", text.substr(colon + 1),
                             "the end of the scale in cd/m^2, e.g. luminance:500", [](double end) { return end > 0; });
  });
}

void add_camera_options(CLI::App& command, PictureGiven& given) {
  option_text(command.get_name(), "--camera");
  const auto take = [&given](const std::vector<std::string>& values) {
    const std::string degrees = std::string("an angle above 0 degrees, e.g. ") + camera_example;
    given.camera = Camera{point("--camera (EYE)", values[0]), point("--camera (TARGET)", values[1]),
                          number("--camera (FOV)", values[2], degrees, [](double x) { return x > 0; })};
  };
  command.add_option_function<std::vector<std::string>>("--camera", take)->expected(3);
  using enum Projection;
  add_choice<Projection>(command, "--projection", given.projection,
                         {{name_of(perspective), perspective},
                          {name_of(orthographic), orthographic},
                          {name_of(angular), angular},
                          {name_of(hemispherical), hemispherical},
                          {name_of(panorama), panorama}});
  add_list(command, "--view", given.views);
}

Camera with_projection(Camera camera, Projection projection) {
  camera.projection = projection;
  if (projection == Projection::orthographic) camera.height = camera.vertical_field_of_view;
  if (has_extent(camera)) return camera;
  const std::string found = std::to_string(std::lround(camera.vertical_field_of_view)) + " degrees";
  throw UsageError("--camera (FOV): found " + found + "; expected an angle above 0 and " +
                   (projection == Projection::perspective ? "below " : "up to ") +
                   std::to_string(std::lround(largest_field_of_view(projection))) + " degrees, e.g. " + camera_example);
}

void require_picture_of(const PictureGiven& given, const std::string& file_option) {
  const bool picture_alone = !given.for_observers;
  const char* const needs = given.camera && picture_alone           ? "--camera"
                            : !given.views.empty() && picture_alone ? "--view"
                            : given.colors                          ? "--false-color"
                            : given.exposure                        ? "--exposure"
                            : given.quality                         ? "--picture-quality"
                            : given.size                            ? "--size"
                            : given.error                           ? "--picture-error"
                            : given.most_samples                    ? "--picture-samples"
                            : !given.error_map.empty()              ? "--picture-error-map"
                                                                    : nullptr;
  if (given.file.empty() && needs != nullptr) throw UsageError(std::string(needs) + " needs " + file_option + " FILE");
  if (std::count(given.views.begin(), given.views.end(), "") > 0) throw refusal("--view", "", "the name of a camera");
  if (given.camera && !given.views.empty())
    throw UsageError("--camera and --view both set the camera; give one of them");
  if (given.projection && !given.camera)
    throw UsageError("--projection needs --camera EYE TARGET FOV; a camera of a scene file states its own");
  if (given.camera && given.camera->eye == given.camera->target)
    throw UsageError("--camera: EYE and TARGET are the same point; expected two different ones");
}

// "room.png" for the view "desk" becomes "room.desk.png"; characters not allowed in file names become "_".
std::filesystem::path with_view(const std::filesystem::path& file, const std::string& view) {
  if (file.empty()) return file;
  std::string name = view;
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter == '/' || letter == '\\' || letter == ':'; }, '_');
  return file.parent_path() / (file.stem().string() + '.' + name + file.extension().string());
}

void require_extension(const std::string& option, const std::string& file, const std::vector<std::string>& allowed) {
  std::string words;
  for (const std::string& extension : allowed) {
    if (path(file).extension() == extension) return;
    words += (words.empty() ? "" : " or ") + extension;
  }
  throw UsageError(option + ": found '" + file + "'; expected a name that ends in " + words);
}

// Sensors come from --points, from a scene file among the models, or from the scene file of stored form factors.
bool may_have_sensors(const SolveArguments& arguments) {
  const auto is_scene_file = [](const path& model) {
    return model.extension() == ".toml" || model.extension() == ".hbjson";
  };
  const std::string& format = arguments.read.format;
  return !arguments.points.empty() || arguments.models.empty() || format == "toml" || format == "hbjson" ||
         std::any_of(arguments.models.begin(), arguments.models.end(), is_scene_file);
}

std::array<double, 2> range_of_map(const std::string& option, const std::string& text) {
  const auto any = [](double) { return true; };
  const std::string expected = "two numbers, the lower first, e.g. 0,500";
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) throw refusal(option, text, expected);
  const std::array<double, 2> range = {number(option, text.substr(0, comma), expected, any),
                                       number(option, text.substr(comma + 1), expected, any)};
  if (!(range[0] < range[1])) throw refusal(option, text, expected);
  return range;
}

bool is_map(const path& file) { return file.extension() == ".svg" || file.extension() == ".png"; }

void require_consistent(const std::string& command, const SolutionOptions& options) {
  const SolveArguments& asked = options.arguments;
  if (options.results.empty() && asked.series.empty() && options.picture.file.empty() && asked.report.empty() &&
      asked.page.empty() && asked.lightmap.folder.empty() && asked.points.empty() && options.points_outputs.empty()) {
    throw UsageError(command +
                     ": nothing would be written; give at least one of -o, --html, --series, --picture, "
                     "--lightmap, --json, --points");
  }
  if (asked.quiet && asked.verbose) throw UsageError("--quiet and -v exclude each other; give one of them");
  for (const std::string& result : options.results) require_extension("-o", result, result_extensions());
  std::vector<std::string> of_readings = points_extensions();
  of_readings.insert(of_readings.end(), {".svg", ".png"});
  for (const std::string& file : options.points_outputs) require_extension("--points-output", file, of_readings);
  if (!asked.series.empty()) require_extension("--series", asked.series.string(), {".pvd"});
}

// Refuses outputs in a folder that is replaced as a whole. The folder need not exist.
void require_outside(const path& folder, const std::string& name, const std::vector<OutputFile>& outputs) {
  std::error_code error;
  const path place = weakly_canonical(absolute(folder) / ".", error);
  const std::string remedy = "' lies in " + name + "; expected a file elsewhere";
  for (const auto& [option, file] : outputs) {
    if (error || file.empty() || weakly_canonical(absolute(file), error).parent_path() / "." != place / ".") continue;
    throw UsageError(std::string(option).append(": '").append(file.string()).append(remedy));
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
  add_name(command, "--points", options.arguments.points, "the name of a file");
  add_list(command, "--points-output", options.points_outputs);
  add(command, "--map", [&options](const std::string& text) {
    options.arguments.map.quantity = choice<MapQuantity>(
        "--map", text, {{"illuminance", MapQuantity::illuminance}, {"daylight-factor", MapQuantity::daylight_factor}});
    options.map_given = "--map";
  });
  add(command, "--map-range", [&options](const std::string& text) {
    options.arguments.map.range = range_of_map("--map-range", text);
    options.map_given = "--map-range";
  });
}

}  // namespace

void add_view_options(CLI::App& command, PictureGiven& given) {
  add_camera_options(command, given);
  add(command, "--size", given.size, size_of_picture);
}

void add_picture_options(CLI::App& command, PictureGiven& given) {
  add_color_options(command, given);
  add_view_options(command, given);
  add_choice<PictureQuality>(command, "--picture-quality", given.quality,
                             {{"draft", PictureQuality::draft}, {"final", PictureQuality::final}});
  add(command, "--picture-error", given.error, relative_error);
  add(command, "--picture-samples", [&given](const std::string& text) {
    const std::uint64_t samples = whole_number("--picture-samples", text, least_picture_samples, most_picture_samples);
    if (!std::has_single_bit(samples)) throw refusal("--picture-samples", text, "a power of two, e.g. 128 or 256");
    given.most_samples = static_cast<int>(samples);
  });
  add_ending(command, "--picture-error-map", given.error_map, ".png");
}

PictureSettings picture_settings(const PictureGiven& given, const std::string& file_option, PictureQuality usual) {
  require_picture_of(given, file_option);
  PictureSettings settings;
  settings.file = given.file;
  settings.error_map = given.error_map;
  settings.views = given.views;
  if (given.camera)
    settings.camera = with_projection(*given.camera, given.projection.value_or(Projection::perspective));
  settings.colors = given.colors.value_or(PictureColors::natural);
  settings.exposure = given.exposure.value_or(Exposure());
  settings.brightest = given.brightest;
  settings.quality = given.quality.value_or(usual);
  if (given.size) settings.size = *given.size;
  settings.error = given.error.value_or(settings.error);
  settings.most_samples = given.most_samples.value_or(settings.most_samples);
  const auto& extensions = picture_extensions();
  if (!given.file.empty() &&
      std::find(extensions.begin(), extensions.end(), settings.file.extension()) == extensions.end())
    throw UsageError(file_option + ": found '" + given.file + "'; expected a name that ends in .png, .hdr or .exr");
  if (settings.quality == PictureQuality::draft && (given.error || given.most_samples || !given.error_map.empty()))
    throw UsageError(std::string(given.error          ? "--picture-error"
                                 : given.most_samples ? "--picture-samples"
                                                      : "--picture-error-map") +
                     " is of final pictures; give --picture-quality final");
  if (given.exposure && given.colors)
    throw UsageError("--exposure is of natural colors; for false colors give --false-color luminance:END");
  if ((given.colors || given.exposure) && settings.file.extension() != ".png")
    throw UsageError(std::string(given.colors ? "--false-color" : "--exposure") + " is of pictures in PNG; found '" +
                     given.file + "', which has luminances themselves");
  return settings;
}

std::vector<PictureSettings> single_pictures(const PictureSettings& settings) {
  if (settings.views.size() < 2) return {settings};
  std::vector<PictureSettings> all;
  for (const std::string& view : settings.views) {
    PictureSettings one = settings;
    one.views = {view};
    one.file = with_view(settings.file, view);
    one.error_map = with_view(settings.error_map, view);
    all.push_back(std::move(one));
  }
  return all;
}

std::vector<OutputFile> picture_files(const PictureSettings& settings, const std::string& file_option) {
  std::vector<OutputFile> files;
  for (const PictureSettings& one : single_pictures(settings)) {
    files.push_back({file_option, one.file});
    files.push_back({"--picture-error-map", one.error_map});
  }
  return files;
}

void add_lightmap_options(CLI::App& command, LightmapSettings& settings) {
  add_name(command, "--lightmap", settings.folder, "the name of a folder");
  add(command, "--texel", settings.options.texel, length);
}

void require_lightmap(const LightmapSettings& settings) {
  if (settings.options.texel && settings.folder.empty()) throw UsageError("--texel needs --lightmap FOLDER");
}

void require_outside_lightmap(const LightmapSettings& settings, const std::vector<OutputFile>& outputs) {
  if (!settings.folder.empty()) require_outside(settings.folder, "the folder of --lightmap", outputs);
}

std::string lightmap_line(const Lightmap& map, const LightmapSettings& settings) {
  const bool is_coarser = settings.options.texel && map.texel > *settings.options.texel;
  return "lightmap: " + std::to_string(map.width) + " x " + std::to_string(map.height) + " texels of " +
         rounded(100 * map.texel) + " cm, " + (is_coarser ? "smaller ones do not fit into the largest map, " : "") +
         std::to_string(map.charts.size()) + (map.charts.size() == 1 ? " chart, " : " charts, ") +
         rounded(static_cast<double>(bytes_of(map)) / 1e6) + " MB of memory\n";
}

void add_ending(CLI::App& command, const std::string& name, path& file, const std::string& ending) {
  add(command, name, file, [ending](const std::string& option, const std::string& text) {
    if (path(text).extension() != ending) throw refusal(option, text, "a name that ends in " + ending);
    return text;
  });
}

void add_json_option(CLI::App& command, path& json) { add_ending(command, "--json", json, ".json"); }

void add_page_option(CLI::App& command, path& page) { add_ending(command, "--html", page, ".html"); }

void require_page_elsewhere(const path& page, const path& folder) {
  require_outside(folder, "the folder of -o", {{"--html", page}});
}

void add_output_options(CLI::App& command, SolutionOptions& options) {
  SolveArguments& to = options.arguments;
  add_list(command, "-o,--output", options.results);
  add(command, "--ambient-occlusion", to.ambient_distance, length);
  add_page_option(command, to.page);
  add_name(command, "--series", to.series, "the name of a file");
  add_name(command, "--json", to.report, "the name of a file");
  add_name(command, "--picture", options.picture.file, "the name of a file");
  add_picture_options(command, options.picture);
  add_lightmap_options(command, to.lightmap);
  add_points_options(command, options);
}

void add_solver_options(CLI::App& command, SolveArguments& arguments) {
  SolverOptions& solver = arguments.request.solver;
  add_closure_option(command, arguments.request);
  add_relaxation_option(command, solver.relaxation);
  add(command, "--solver", [&arguments](const std::string& text) {
    arguments.solver_given = true;
    arguments.request.solver.solver = solver_named("--solver", text);
  });
  add_tolerance_option(command, 0, solver.relative_error);
  add_whole(command, "--max-iterations", solver.max_iterations, 0, 1'000'000'000);
  add(command, "--max-rows", solver.max_rows, share);
}

void add_verbosity_options(CLI::App& command, SolveArguments& arguments) {
  add_flag(command, "--discard", arguments.discards);
  add_quiet_option(command, arguments.quiet);
  add_flag(command, "-v,--verbose", arguments.verbose);
}

SolveArguments with_solution(const SolutionOptions& options, const std::string& command) {
  require_consistent(command, options);
  SolveArguments arguments = options.arguments;
  if (!arguments.series.empty() && !arguments.solver_given) arguments.request.solver.solver = Solver::jacobi;
  arguments.results.assign(options.results.begin(), options.results.end());
  arguments.picture = picture_settings(options.picture, "--picture", PictureQuality::draft);
  require_lightmap(arguments.lightmap);
  if (arguments.picture.views.size() > 1)
    throw UsageError("--view: found several; expected one, as patchlight render takes pictures of more");
  arguments.points_outputs.assign(options.points_outputs.begin(), options.points_outputs.end());
  arguments.default_points_output = default_points_output(arguments);
  if (!arguments.points.empty() && arguments.points_outputs.empty())
    arguments.points_outputs = {arguments.default_points_output};
  if (!arguments.points_outputs.empty() && !may_have_sensors(arguments))
    throw UsageError("--points-output needs --points FILE, or a scene file with sensors");
  const auto is_vtk = [](const path& result) { return result.extension() == ".vtp" || result.extension() == ".vtu"; };
  if (arguments.ambient_distance && std::none_of(arguments.results.begin(), arguments.results.end(), is_vtk))
    throw UsageError("--ambient-occlusion is written into results for ParaView; expected -o RESULT.vtp");
  if (!options.map_given.empty() &&
      std::none_of(arguments.points_outputs.begin(), arguments.points_outputs.end(), is_map))
    throw UsageError(options.map_given + " is of maps of sensors; expected --points-output FILE.svg or FILE.png");
  require_distinct(outputs_of(arguments));
  require_outside_lightmap(arguments.lightmap, outputs_of(arguments));
  require_not_read(outputs_of(arguments), given_files(arguments));
  if (std::error_code error; is_directory(arguments.form_factors, error))
    require_outside(arguments.form_factors, "the folder of form factors", outputs_of(arguments));
  return arguments;
}

std::vector<OutputFile> outputs_of(const CheckArguments& arguments) {
  return {{"--json", arguments.json}, {"--problems", arguments.problems}, {"--picture", arguments.picture.file}};
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
