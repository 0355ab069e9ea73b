#include "cli/output_options.h"

#include "patchlight/output/write_result.h"

#include "base/rounded.h"
#include "cli/options.h"
#include "cli/parse_value.h"
#include "output/image/write_image.h"
#include "output/image/write_lightmap.h"
#include "output/vtk/write_points.h"
#include "scene/projection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <system_error>
#include <utility>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

constexpr std::uint64_t most_pixels_per_edge = 32768;

std::array<int, 2> size_of_picture(const std::string& text) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) throw refusal("--size", text, "width and height in pixels, e.g. 1600x900");
  const auto edge = [](const std::string& part) {
    return static_cast<int>(whole_number("--size", part, 1, most_pixels_per_edge));
  };
  return {edge(text.substr(0, cross)), edge(text.substr(cross + 1))};
}

Projection projection_asked(const std::string& text) {
  using enum Projection;
  return choice<Projection>("--projection", text,
                            {{name_of(perspective), perspective},
                             {name_of(orthographic), orthographic},
                             {name_of(angular), angular},
                             {name_of(hemispherical), hemispherical},
                             {name_of(panorama), panorama}});
}

void add_camera_options(CLI::App& command, PictureGiven& given) {
  option_text(command.get_name(), "--camera");
  const auto take = [&given](const std::vector<std::string>& values) {
    const std::string degrees = std::string("an angle above 0 degrees, e.g. ") + camera_example;
    given.camera = Camera{point("--camera (EYE)", values[0]), point("--camera (TARGET)", values[1]),
                          number("--camera (FOV)", values[2], degrees, [](double x) { return x > 0; })};
  };
  command.add_option_function<std::vector<std::string>>("--camera", take)->expected(3);
  add(command, "--projection", [&given](const std::string& text) { given.projection = projection_asked(text); });
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
                            : given.quality                         ? "--picture-quality"
                            : given.size                            ? "--size"
                            : given.error                           ? "--picture-error"
                            : given.most_samples                    ? "--picture-samples"
                            : !given.error_map.empty()              ? "--picture-error-map"
                                                                    : nullptr;
  if (given.file.empty() && needs != nullptr) throw UsageError(std::string(needs) + " needs " + file_option + " FILE");
  if (std::count(given.views.begin(), given.views.end(), "") > 0) throw refusal("--view", "", "the name of a camera");
  if (given.camera && !given.views.empty())
    throw UsageError("--camera and --view both say where the picture is taken from; give one of them");
  if (given.projection && !given.camera)
    throw UsageError("--projection needs --camera EYE TARGET FOV; a camera of a scene file states its own");
  if (given.camera && given.camera->eye == given.camera->target)
    throw UsageError("--camera: EYE and TARGET are the same point; expected two different ones");
}

// "room.png" of the view "desk": "room.desk.png", with "_" for characters that file names do not allow.
std::filesystem::path with_view(const std::filesystem::path& file, const std::string& view) {
  if (file.empty()) return file;
  std::string name = view;
  std::replace_if(
      name.begin(), name.end(), [](char letter) { return letter == '/' || letter == '\\' || letter == ':'; }, '_');
  return file.parent_path() / (file.stem().string() + '.' + name + file.extension().string());
}

// Adds an option that holds the name of a file.
void add_file(CLI::App& command, const std::string& name, std::string& file) {
  add(command, name, [&file, name](const std::string& text) {
    if (text.empty()) throw refusal(name.substr(0, name.find(',')), text, "the name of a file");
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
  const std::string expected = "two numbers, the lower first, e.g. 0,500";
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
  add_file(command, "--points", options.points);
  add_list(command, "--points-output", options.points_outputs);
  add(command, "--map", [&options](const std::string& text) {
    options.map.quantity = choice<MapQuantity>(
        "--map", text, {{"illuminance", MapQuantity::illuminance}, {"daylight-factor", MapQuantity::daylight_factor}});
    options.map_given = "--map";
  });
  add(command, "--map-range", [&options](const std::string& text) {
    options.map.range = range_of_map(text);
    options.map_given = "--map-range";
  });
}

}  // namespace

void add_view_options(CLI::App& command, PictureGiven& given) {
  add_camera_options(command, given);
  add(command, "--size", [&given](const std::string& text) { given.size = size_of_picture(text); });
}

void add_picture_options(CLI::App& command, PictureGiven& given) {
  add(command, "--false-color", [&given](const std::string& text) {
    given.colors = choice<PictureColors>("--false-color", text, {{"luminance", PictureColors::luminance}});
  });
  add_view_options(command, given);
  add(command, "--picture-quality", [&given](const std::string& text) {
    given.quality = choice<PictureQuality>("--picture-quality", text,
                                           {{"draft", PictureQuality::draft}, {"final", PictureQuality::final}});
  });
  add(command, "--picture-error",
      [&given](const std::string& text) { given.error = relative_error("--picture-error", text); });
  add(command, "--picture-samples", [&given](const std::string& text) {
    const std::uint64_t samples = whole_number("--picture-samples", text, least_picture_samples, most_picture_samples);
    if (!std::has_single_bit(samples)) throw refusal("--picture-samples", text, "a power of two, e.g. 128 or 256");
    given.most_samples = static_cast<int>(samples);
  });
  add_file(command, "--picture-error-map", given.error_map);
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
  settings.quality = given.quality.value_or(usual);
  if (given.size) settings.size = *given.size;
  settings.error = given.error.value_or(settings.error);
  settings.most_samples = given.most_samples.value_or(settings.most_samples);
  const auto& extensions = picture_extensions();
  if (!given.file.empty() &&
      std::find(extensions.begin(), extensions.end(), settings.file.extension()) == extensions.end())
    throw UsageError(file_option + ": found '" + given.file + "'; expected a name that ends in .png, .hdr or .exr");
  if (!given.error_map.empty() && settings.error_map.extension() != ".png")
    throw UsageError("--picture-error-map: found '" + given.error_map + "'; expected a name that ends in .png");
  if (settings.quality == PictureQuality::draft && (given.error || given.most_samples || !given.error_map.empty()))
    throw UsageError(std::string(given.error          ? "--picture-error"
                                 : given.most_samples ? "--picture-samples"
                                                      : "--picture-error-map") +
                     " is of final pictures; give --picture-quality final");
  if (given.colors && settings.file.extension() != ".png")
    throw UsageError("--false-color is of pictures in PNG; found '" + given.file +
                     "', which has luminances themselves");
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

void add_lightmap_options(CLI::App& command, LightmapGiven& given) {
  add(command, "--lightmap", [&given](const std::string& text) {
    if (text.empty()) throw refusal("--lightmap", text, "the name of a folder");
    given.folder = text;
  });
  add(command, "--texel", [&given](const std::string& text) { given.texel = length("--texel", text); });
}

LightmapSettings lightmap_settings(const LightmapGiven& given) {
  if (given.texel && given.folder.empty()) throw UsageError("--texel needs --lightmap FOLDER");
  return {given.folder, {given.texel}};
}

void require_outside_lightmap(const LightmapSettings& settings, const std::vector<OutputFile>& outputs) {
  if (settings.folder.empty()) return;
  std::error_code error;
  const auto folder = weakly_canonical(absolute(settings.folder) / ".", error);
  for (const auto& [option, file] : outputs) {
    if (error || file.empty() || weakly_canonical(absolute(file), error).parent_path() / "." != folder / ".") continue;
    throw UsageError(option + ": '" + file.string() + "' lies in the folder of --lightmap; expected a file elsewhere");
  }
}

std::string lightmap_line(const Lightmap& map, const LightmapSettings& settings) {
  const bool is_coarser = settings.options.texel && map.texel > *settings.options.texel;
  return "lightmap: " + std::to_string(map.width) + " x " + std::to_string(map.height) + " texels of " +
         rounded(100 * map.texel) + " cm, " + (is_coarser ? "smaller ones do not fit into the largest map, " : "") +
         std::to_string(map.charts.size()) + (map.charts.size() == 1 ? " chart, " : " charts, ") +
         rounded(static_cast<double>(bytes_of(map)) / 1e6) + " MB of memory\n";
}

void add_json_option(CLI::App& command, std::string& json) {
  add(command, "--json", [&json](const std::string& text) {
    if (path(text).extension() != ".json") throw refusal("--json", text, "a name that ends in .json");
    json = text;
  });
}

void add_page_option(CLI::App& command, std::string& page) {
  add(command, "--html", [&page](const std::string& text) {
    if (path(text).extension() != ".html") throw refusal("--html", text, "a name that ends in .html");
    page = text;
  });
}

void require_page_elsewhere(const std::filesystem::path& page, const std::filesystem::path& folder) {
  if (page.empty()) return;
  const auto folder_of = [](const std::filesystem::path& file) {
    std::error_code error;
    return weakly_canonical(absolute(file), error).parent_path();
  };
  // The folder need not be there yet.
  if (folder_of(page) != folder_of(folder / "file")) return;
  throw UsageError("--html: '" + page.string() + "' lies in the folder of -o; expected a file elsewhere");
}

void add_output_options(CLI::App& command, SolutionOptions& options) {
  add_list(command, "-o,--output", options.results);
  add(command, "--ambient-occlusion",
      [&options](const std::string& text) { options.ambient_distance = length("--ambient-occlusion", text); });
  add_page_option(command, options.page);
  add_file(command, "--series", options.series);
  add_file(command, "--json", options.report);
  add_file(command, "--picture", options.picture.file);
  add_picture_options(command, options.picture);
  add_lightmap_options(command, options.lightmap);
  add_points_options(command, options);
}

void add_solver_options(CLI::App& command, SolutionOptions& options, Request& request) {
  add_closure_option(command, request);
  add_relaxation_option(command, request.solver.relaxation);
  add(command, "--solver", [&request, &options](const std::string& text) {
    options.solver_given = true;
    request.solver.solver = solver_named("--solver", text);
  });
  add_tolerance_option(command, 0, [&request](double error) { request.solver.relative_error = error; });
  add(command, "--max-iterations", [&request](const std::string& text) {
    request.solver.max_iterations = static_cast<int>(whole_number("--max-iterations", text, 0, 1'000'000'000));
  });
  add(command, "--max-rows",
      [&request](const std::string& text) { request.solver.max_rows = share("--max-rows", text); });
}

void add_verbosity_options(CLI::App& command, SolutionOptions& options) {
  add_flag(command, "--discard", [&options] { options.discards = true; });
  add_quiet_option(command, options.quiet);
  add_flag(command, "-v,--verbose", [&options] { options.verbose = true; });
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
