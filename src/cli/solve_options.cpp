#include "cli/solve_options.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_result.h"

#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"

#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

struct CameraOption {
  Point eye;
  Point target;
  double field_of_view = 0;
};

}  // namespace

struct SolveOptions {
  ModelOptions model;
  std::vector<std::string> results;
  std::string series, report, picture, points, points_output, form_factors;
  bool solver_given = false;
  std::optional<Vector> up;
  std::optional<CameraOption> camera;
  std::optional<PictureColors> colors;
  MeshOptions mesh;
  bool quiet = false;
  bool verbose = false;
};

namespace {

// Adds an option with one value, which `take` understands or refuses.
template <typename Take>
CLI::Option* add(CLI::App& command, const std::string& name, const std::string& value, const std::string& help,
                 Take take) {
  return command.add_option_function<std::string>(name, take, help)->option_text(value);
}

// Adds an option that holds the name of a file.
void add_file(CLI::App& command, const std::string& name, std::string& file, const std::string& help) {
  const std::string option = name.substr(name.rfind(',') + 1);
  add(command, name, "FILE", help, [&file, option](const std::string& text) {
    if (text.empty()) throw UsageError(option + ": found an empty name; expected the name of a file");
    file = text;
  });
}

void add_outputs(CLI::App& command, SolveOptions& options) {
  command
      .add_option("-o,--output", options.results,
                  "solved patches: for ParaView (.vtp), or with vertex colors for\nviewers and the web (.ply, .glb); "
                  "may be repeated")
      ->allow_extra_args(false)
      ->option_text("FILE");
  add_file(command, "--series", options.series,
           "the iterations one by one for ParaView (.pvd); with the Jacobi\nsolver, then the default, iteration k is "
           "bounce k");
  add_file(command, "--report", options.report, "what was asked, decided and found, with energy balance (JSON)");
  add_file(command, "--picture", options.picture, "a picture of the solution (.png), 800 x 800 pixels");
  add(command, "--false-color", "luminance", "picture in false colors with a legend in cd/m^2; default: natural colors",
      [&options](const std::string& text) {
        options.colors = choice<PictureColors>("--false-color", text, {{"luminance", PictureColors::luminance}});
      });
  command
      .add_option_function<std::vector<std::string>>(
          "--camera",
          [&options](const std::vector<std::string>& values) {
            const auto angle = [](double x) { return x > 0 && x < 180; };
            options.camera = {point("--camera (EYE)", values[0]), point("--camera (TARGET)", values[1]),
                              number("--camera (FOV)", values[2], "an angle above 0 and below 180 degrees", angle)};
          },
          "view of the picture: eye and target as X,Y,Z in model\nunits, vertical field of view in degrees; "
          "default: a view\nfrom within the scene's bounds that shows most of it")
      ->expected(3)
      ->option_text("EYE TARGET FOV");
}

void add_points(CLI::App& command, SolveOptions& options) {
  add_file(command, "--points", options.points,
           "points where irradiance is wanted: lines x y z nx ny nz,\nposition in model units and direction of the "
           "receiving side");
  add_file(command, "--points-output", options.points_output,
           "irradiance at these points in W/m^2 per band (CSV);\ndefault: the points file's name with "
           ".irradiance.csv, in\nthe folder of -o, else in the current one");
}

void add_model(CLI::App& command, SolveOptions& options) {
  add_model_options(command, options.model);
  add(command, "--up", "y|z",
      "the model's upright axis, for the picture; default: as the\nformat says (y: glTF; z: IFC), else that across "
      "which most\narea lies, or against the lamps' light",
      [&options](const std::string& text) {
        options.up = choice<Vector>("--up", text, {{"y", Vector::UnitY()}, {"z", Vector::UnitZ()}});
      });
  add_sides_option(command, options.mesh);
}

void add_accuracy(CLI::App& command, SolveOptions& options) {
  Request& request = options.mesh.request;
  add_patch_options(command, options.mesh);
  add(command, "--form-factors", "FOLDER",
      "what patchlight form-factors has written for this model:\ntaken from there, with the options of then; "
      "default:\ncomputed",
      [&options](const std::string& text) {
        if (text.empty()) throw refusal("--form-factors", text, "the name of a folder");
        options.form_factors = text;
      });
  command.add_flag_callback(
      "--no-closure", [&request] { request.close = false; },
      "form factors as computed; default: rows closed, so that no light\nis lost or made by their errors");
  command.add_flag_callback(
      "--on-demand", [&request] { request.on_demand = true; },
      "no matrix: form factors are computed whenever the solver asks for\nthem, and not closed; little memory, a first "
      "picture early;\nneeds --solver progressive; default: all are computed and kept");
  add(command, "--solver", "jacobi|gauss-seidel|progressive",
      "how the equations are solved; default gauss-seidel, with\n--series jacobi",
      [&request, &options](const std::string& text) {
        options.solver_given = true;
        request.solver = choice<Solver>(
            "--solver", text,
            {{"jacobi", Solver::jacobi}, {"gauss-seidel", Solver::gauss_seidel}, {"progressive", Solver::progressive}});
      });
  add(command, "--tolerance", "NUMBER", "relative error at which the solver stops; default 1e-6",
      [&request](const std::string& text) {
        const auto inside = [](double x) { return x > 0 && x < 1; };
        request.tolerance = number("--tolerance", text, "a number above 0 and below 1", inside);
      });
  add(command, "--max-iterations", "N", "the solver gives up after so many iterations; default 1000",
      [&request](const std::string& text) {
        request.max_iterations = static_cast<int>(whole_number("--max-iterations", text, 0, 1'000'000'000));
      });
  add_sampling_options(command, options.mesh);
}

void require_extension(const std::string& option, const std::string& file, const std::vector<std::string>& allowed) {
  std::string words;
  for (const std::string& extension : allowed) {
    if (path(file).extension() == extension) return;
    words += (words.empty() ? "" : " or ") + extension;
  }
  throw UsageError(option + ": found '" + file + "'; expected a name that ends in " + words);
}

void require_consistent(const SolveOptions& options) {
  if (options.model.models.empty())
    throw UsageError("solve: found no model; expected: patchlight solve MODEL -o RESULT.vtp");
  if (options.results.empty() && options.series.empty() && options.picture.empty() && options.report.empty() &&
      options.points.empty()) {
    throw UsageError(
        "solve: nothing would be written; give at least one of -o, --series, --picture, --report, --points");
  }
  if (options.picture.empty() && (options.camera || options.colors)) {
    throw UsageError(std::string(options.camera ? "--camera" : "--false-color") + " needs --picture FILE");
  }
  if (options.points.empty() && !options.points_output.empty()) {
    throw UsageError("--points-output needs --points FILE");
  }
  if (options.camera && options.camera->eye == options.camera->target) {
    throw UsageError("--camera: EYE and TARGET are the same point; expected two different ones");
  }
  if (options.quiet && options.verbose) throw UsageError("--quiet and -v exclude each other; give one of them");
  for (const std::string& result : options.results) require_extension("-o", result, result_extensions());
  if (!options.series.empty()) require_extension("--series", options.series, {".pvd"});
  if (!options.picture.empty()) require_extension("--picture", options.picture, {".png"});
}

// Rows on demand serve a solver that asks for few of them, and cannot be closed, as that takes all.
void require_solver_of_rows(const SolveOptions& options) {
  const Request& request = options.mesh.request;
  if (!request.on_demand) return;
  if (request.solver != Solver::progressive) throw UsageError("--on-demand needs --solver progressive");
  const char* const other = !options.form_factors.empty()               ? "--form-factors"
                            : !request.close                            ? "--no-closure"
                            : request.estimator != Estimator::automatic ? "--estimator"
                                                                        : nullptr;
  if (other != nullptr) {
    throw UsageError(std::string(other) + " and --on-demand exclude each other; give one of them");
  }
}

// Every output must be a file of its own, and no output may replace an input.
void require_distinct_files(const SolveArguments& arguments) {
  std::vector<std::pair<const char*, const path*>> files = {{"--points", &arguments.points},
                                                            {"--series", &arguments.series},
                                                            {"--report", &arguments.report},
                                                            {"--picture", &arguments.picture},
                                                            {"--points-output", &arguments.points_output}};
  for (const path& model : arguments.models) files.insert(files.begin(), {"a model", &model});
  for (const path& result : arguments.results) files.emplace_back("-o", &result);
  for (std::size_t b = 1; b < files.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (files[a].second->empty() || files[b].second->empty()) continue;
      if (weakly_canonical(*files[a].second) == weakly_canonical(*files[b].second)) {
        throw UsageError(std::string(files[b].first) + ": '" + files[b].second->string() + "' is also " +
                         files[a].first + "; expected different files");
      }
    }
  }
}

path points_output(const SolveOptions& options) {
  if (options.points.empty() || !options.points_output.empty()) return options.points_output;
  const path beside = options.results.empty() ? path() : path(options.results.front());
  return beside.parent_path() / (path(options.points).stem().string() + ".irradiance.csv");
}

}  // namespace

std::shared_ptr<SolveOptions> add_solve(CLI::App& tool) {
  auto options = std::make_shared<SolveOptions>();
  CLI::App& command = *tool.add_subcommand("solve", "solves a model: interreflected light on all its surfaces");
  add_model(command, *options);
  add_outputs(command, *options);
  add_points(command, *options);
  add_accuracy(command, *options);
  command.add_flag("-q,--quiet", options->quiet, "says nothing but errors; default: progress and a summary");
  command.add_flag("-v,--verbose", options->verbose, "adds decisions, counts and speed to the summary; default: off");
  return options;
}

SolveArguments finish_solve(const SolveOptions& options) {
  require_consistent(options);
  require_solver_of_rows(options);
  const double metres = options.model.metres_per_unit;
  SolveArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.read.up = options.up;
  arguments.request = mesh_request(options.mesh, metres);
  arguments.form_factors = options.form_factors;
  if (!options.series.empty() && !options.solver_given) arguments.request.solver = Solver::jacobi;
  arguments.results.assign(options.results.begin(), options.results.end());
  arguments.series = options.series;
  arguments.report = options.report;
  arguments.picture = options.picture;
  arguments.colors = options.colors.value_or(PictureColors::natural);
  if (options.camera) {
    arguments.camera =
        Camera{options.camera->eye * metres, options.camera->target * metres, options.camera->field_of_view};
  }
  arguments.points = options.points;
  arguments.points_output = points_output(options);
  if (options.quiet) arguments.verbosity = Verbosity::quiet;
  if (options.verbose) arguments.verbosity = Verbosity::verbose;
  require_distinct_files(arguments);
  return arguments;
}

}  // namespace patchlight::cli
