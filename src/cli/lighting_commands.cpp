// Options of the commands that light a model: check, init, solve, render, plan, relight.
#include "base/near_match.h"
#include "cli/distinct_files.h"
#include "cli/option_names.h"
#include "cli/options.h"
#include "cli/output_options.h"
#include "cli/parse_value.h"
#include "plan/check_request.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

constexpr int most_models = 1'000'000;

struct CheckOptions {
  ModelOptions model;
  std::optional<Sides> sides;
  std::string problems, json;
  PictureGiven picture;
  std::optional<double> ambient_distance;
  bool wants_json = false;
  bool all = false;
};

void add_json_of_check(CLI::App& command, CheckOptions& to) {
  option_text("check", "--json");
  const auto take = [&to](const std::vector<std::string>& values) {
    // In "check --json room.obj" the word after --json is the model.
    to.wants_json = true;
    for (const std::string& value : values) {
      if (path(value).extension() == ".json") {
        to.json = value;
      } else if (!value.empty()) {
        to.model.models.push_back(value);
      }
    }
  };
  command.add_option_function<std::vector<std::string>>("--json", take)->expected(0, most_models);
}

CheckArguments finish_check(const CheckOptions& options) {
  CheckArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.sides = options.sides;
  arguments.all = options.all;
  arguments.json = options.json;
  arguments.json_on_stdout = options.wants_json && arguments.json.empty();
  arguments.problems = options.problems;
  if (arguments.models.empty()) throw UsageError("check: no model given\nhint: patchlight check MODEL");
  if (!options.problems.empty() && path(options.problems).extension() != ".vtp")
    throw refusal("--problems", options.problems, "a name that ends in .vtp");
  const std::string& picture = options.picture.file;
  if (!picture.empty() && !picture.ends_with(".png") && !picture.ends_with(".hdr"))
    throw refusal("--picture", picture, "a name that ends in .png or .hdr");
  arguments.picture = picture_settings(options.picture, "--picture", PictureQuality::draft);
  if (arguments.picture.views.size() > 1) throw UsageError("--view: check --picture takes one view only");
  arguments.ambient_distance = options.ambient_distance;
  if (options.ambient_distance && picture.empty()) throw UsageError("--ambient-occlusion needs --picture FILE");
  const std::vector<OutputFile> outputs = {
      {"--json", arguments.json}, {"--problems", arguments.problems}, {"--picture", arguments.picture.file}};
  require_distinct(outputs);
  require_not_read(outputs, arguments.models);
  return arguments;
}

struct InitOptions {
  ModelOptions model;
  std::string output;
};

InitArguments finish_init(const InitOptions& options) {
  if (options.model.models.empty() || options.output.empty())
    throw UsageError(std::string("init: no ") + (options.model.models.empty() ? "model" : "-o SCENE.toml") +
                     " given\nhint: patchlight init MODEL -o SCENE.toml");
  InitArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.output = options.output;
  for (const path& model : arguments.models) {
    if (model == "-" || model.extension() == ".toml")
      throw UsageError("init: '" + model.string() + "' is no model file, which a scene file could name");
  }
  require_not_read({{"-o", arguments.output}}, arguments.models);
  return arguments;
}

struct SolveOptions {
  ModelOptions model;
  RequestGiven request;
  SolutionOptions solution;
  std::string form_factors;
  std::string checkpoint;
};

void add_stored_form_factors(CLI::App& command, SolveOptions& to) {
  add(command, "--form-factors", [&to](const std::string& text) {
    if (text.empty()) throw refusal("--form-factors", text, "the name of a folder");
    to.form_factors = text;
  });
  add(command, "--checkpoint", [&to](const std::string& text) {
    if (text.empty()) throw refusal("--checkpoint", text, "the name of a folder");
    to.checkpoint = text;
    if (to.request.assembly.storage == Storage::automatic) to.request.assembly.storage = Storage::rays;
  });
}

void require_checkpoint_of_rays(const SolveArguments& arguments) {
  if (arguments.checkpoint.empty()) return;
  if (!arguments.form_factors.empty())
    throw UsageError("--checkpoint cannot be used with --form-factors, which are computed already");
  if (arguments.request.assembly.storage != Storage::rays)
    throw UsageError(with_option_names("--checkpoint cannot be used with assembly.storage=" +
                                       std::string(name_of(arguments.request.assembly.storage)) +
                                       "\nhint: --method rays"));
}

SolveArguments finish_solve(const SolveOptions& options) {
  if (options.model.models.empty())
    throw UsageError("solve: no model given\nhint: patchlight solve MODEL -o RESULT.vtp");
  SolveArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = in_metres(options.request, options.model.metres_per_unit.value_or(1));
  arguments.form_factors = options.form_factors;
  arguments.checkpoint = options.checkpoint;
  arguments = with_solution(std::move(arguments), "solve", options.solution);
  const bool in_series = !options.solution.series.empty();
  Storage& storage = arguments.request.assembly.storage;
  if (in_series && storage == Storage::automatic) storage = Storage::tiles;
  arguments.request = with_fitting_solver(std::move(arguments.request), options.solution.solver_given || in_series);
  require_checkpoint_of_rays(arguments);
  check(arguments.request, {.form_factors = !arguments.form_factors.empty()});
  return arguments;
}

struct RelightOptions {
  std::string folder;
  std::vector<std::string> settings;
  std::optional<Vector> up;
  DaylightSetting daylight;
  Request request;
  SolutionOptions solution;
};

SolveArguments finish_relight(const RelightOptions& options) {
  if (options.folder.empty())
    throw UsageError("relight: no folder given\nhint: patchlight relight FOLDER -o RESULT.vtp");
  SolveArguments arguments;
  arguments.form_factors = options.folder;
  arguments.read.settings = material_settings(options.settings);
  arguments.read.up = options.up;
  arguments.read.daylight = options.daylight;
  arguments.request = options.request;
  arguments = with_solution(std::move(arguments), "relight", options.solution);
  check(arguments.request, {.form_factors = true});
  return arguments;
}

struct PlanOptions {
  ModelOptions model;
  RequestGiven request;
  std::string json;
};

PlanArguments finish_plan(const PlanOptions& options) {
  if (options.model.models.empty()) throw UsageError("plan: no model given\nhint: patchlight plan MODEL");
  PlanArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = with_fitting_solver(in_metres(options.request, options.model.metres_per_unit.value_or(1)), false);
  arguments.json = options.json;
  check(arguments.request);
  require_not_read({{"--json", arguments.json}}, arguments.models);
  return arguments;
}

struct RenderOptionsGiven {
  ModelOptions model;
  PictureGiven picture;
  LightmapGiven lightmap;
  std::string solution, observers, difference, page;
  int threads = 0;
  bool quiet = false;
};

void require_solution(const std::string& option, const std::string& text) {
  if (text.ends_with(".vtu"))
    throw UsageError(option + ": '" + text +
                     "' is a grid (.vtu), which lacks facts that images need\n"
                     "hint: solve with -o RESULT.vtp and give that file");
  if (!text.ends_with(".vtp")) throw refusal(option, text, "a name that ends in .vtp");
}

// The refusal without a solution, which may stand in the place of the model.
std::string without_solution(const std::vector<std::string>& models) {
  const auto is_result = [](const std::string& file) { return in_lower_case(file).ends_with(".vtp"); };
  const auto result = std::find_if(models.begin(), models.end(), is_result);
  if (result == models.end()) return "no solution given\nhint: --solution RESULT.vtp, from patchlight solve";
  return *result + " is a solution, not a model\nhint: patchlight render MODEL --solution " + shell_word(*result) +
         " -o VIEW.png";
}

void add_render_options(CLI::App& command, RenderOptionsGiven& to) {
  add(command, "--solution", [&to](const std::string& text) {
    require_solution("--solution", text);
    to.solution = text;
  });
  add(command, "-o,--output", [&to](const std::string& text) {
    if (text.empty()) throw refusal("-o", text, "the name of a file");
    to.picture.file = text;
  });
  add_picture_options(command, to.picture);
  add(command, "--difference", [&to](const std::string& text) {
    require_solution("--difference", text);
    to.difference = text;
  });
  add(command, "--observers", [&to](const std::string& text) {
    if (!text.ends_with(".csv")) throw refusal("--observers", text, "a name that ends in .csv");
    to.observers = text;
  });
}

void require_consistent(const RenderOptionsGiven& options) {
  if (options.model.models.empty())
    throw UsageError("render: no model given\nhint: patchlight render MODEL --solution RESULT.vtp -o VIEW.png");
  if (options.solution.empty()) throw UsageError("render: " + without_solution(options.model.models));
  if (options.picture.file.empty() && options.observers.empty() && options.lightmap.folder.empty())
    throw UsageError("render: nothing would be written\nhint: -o VIEW.png, --observers FILE.csv or --lightmap FOLDER");
  if (options.picture.file.empty() && !options.page.empty())
    throw UsageError("--html: the page shows the images of render, and there is none\nhint: -o VIEW.png");
  if (!options.difference.empty() && (!options.picture.file.ends_with(".png") || options.picture.colors))
    throw UsageError("--difference is an image in natural colors\nhint: -o FILE.png, without --false-color");
}

RenderArguments finish_render(const RenderOptionsGiven& options) {
  require_consistent(options);
  RenderArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.solution = options.solution;
  arguments.page = options.page;
  arguments.observers = options.observers;
  arguments.difference = options.difference;
  arguments.lightmap = lightmap_settings(options.lightmap);
  PictureGiven given = options.picture;
  given.for_observers = !options.observers.empty();
  arguments.picture = picture_settings(given, "-o", PictureQuality::final);
  arguments.threads = options.threads;
  arguments.quiet = options.quiet;
  std::vector<path> read = arguments.models;
  read.push_back(arguments.solution);
  if (!arguments.difference.empty()) read.push_back(arguments.difference);
  std::vector<OutputFile> outputs = picture_files(arguments.picture, "-o");
  outputs.push_back({"--observers", arguments.observers});
  outputs.push_back({"--html", arguments.page});
  require_outside_lightmap(arguments.lightmap, outputs);
  outputs.push_back({"--lightmap", arguments.lightmap.folder});
  require_distinct(outputs);
  require_not_read(outputs, read);
  if (!arguments.lightmap.folder.empty()) require_not_read_from({"--lightmap", arguments.lightmap.folder}, read);
  return arguments;
}

}  // namespace

Finish add_check(CLI::App& tool) {
  auto to = std::make_shared<CheckOptions>();
  CLI::App& command = *tool.add_subcommand("check");
  add_model_options(command, to->model);
  add(command, "--sides", [&to = *to](const std::string& text) { to.sides = sides_named(text); });
  add_flag(command, "--all", [&to = *to] { to.all = true; });
  add_json_of_check(command, *to);
  add(command, "--problems", [&to = *to](const std::string& text) { to.problems = text; });
  add(command, "--picture", [&to = *to](const std::string& text) { to.picture.file = text; });
  add_view_options(command, to->picture);
  add(command, "--ambient-occlusion",
      [&to = *to](const std::string& text) { to.ambient_distance = length("--ambient-occlusion", text); });
  return [to] { return finish_check(*to); };
}

Finish add_init(CLI::App& tool) {
  auto to = std::make_shared<InitOptions>();
  CLI::App& command = *tool.add_subcommand("init");
  add_file_options(command, to->model);
  add(command, "-o,--output", [&to = *to](const std::string& text) {
    if (!text.ends_with(".toml")) throw refusal("-o", text, "a name that ends in .toml");
    to.output = text;
  });
  return [to] { return finish_init(*to); };
}

Finish add_solve(CLI::App& tool) {
  auto to = std::make_shared<SolveOptions>();
  CLI::App& command = *tool.add_subcommand("solve");
  add_model_options(command, to->model);
  add_sides_option(command, to->request);
  add_output_options(command, to->solution);
  add_patch_options(command, to->request);
  add_graded_option(command, to->request);
  add_accuracy_options(command, to->request);
  add_method_options(command, to->request);
  add_stored_form_factors(command, *to);
  add_effect_options(command, to->request, effects_but({}));
  add_solver_options(command, to->solution, to->request);
  add_sampling_options(command, to->request);
  add_machine_options(command, to->request);
  add_verbosity_options(command, to->solution);
  return [to] { return finish_solve(*to); };
}

Finish add_relight(CLI::App& tool) {
  auto to = std::make_shared<RelightOptions>();
  CLI::App& command = *tool.add_subcommand("relight");
  add(command, "FOLDER", [&to = *to](const std::string& text) { to.folder = text; });
  add_set_option(command, to->settings);
  add_up_option(command, to->up);
  add_daylight_options(command, to->daylight);
  add_effect_options(command, to->request,
                     effects_but({Effect::occlusion, Effect::reach, Effect::backs, Effect::textures}));
  add_output_options(command, to->solution);
  add_solver_options(command, to->solution, to->request);
  add_machine_options(command, to->request);
  add_verbosity_options(command, to->solution);
  return [to] { return finish_relight(*to); };
}

Finish add_plan(CLI::App& tool) {
  auto to = std::make_shared<PlanOptions>();
  CLI::App& command = *tool.add_subcommand("plan");
  add_model_options(command, to->model);
  add_sides_option(command, to->request);
  add_json_option(command, to->json);
  add_patch_options(command, to->request);
  add_graded_option(command, to->request);
  add_accuracy_options(command, to->request);
  add_method_options(command, to->request);
  add_closure_option(command, to->request);
  add_effect_options(command, to->request, effects_but({}));
  add_sampling_options(command, to->request);
  add_machine_options(command, to->request);
  return [to] { return finish_plan(*to); };
}

Finish add_render(CLI::App& tool) {
  auto to = std::make_shared<RenderOptionsGiven>();
  CLI::App& command = *tool.add_subcommand("render");
  add_model_options(command, to->model);
  add_render_options(command, *to);
  add_lightmap_options(command, to->lightmap);
  add_page_option(command, to->page);
  add_threads_option(command, to->threads);
  add_quiet_option(command, to->quiet);
  return [to] { return finish_render(*to); };
}

}  // namespace patchlight::cli
