// Options of the commands that light a model: check, init, solve, render, plan, relight.
#include "base/words.h"
#include "cli/distinct_files.h"
#include "cli/option_names.h"
#include "cli/options.h"
#include "cli/output_options.h"
#include "plan/check_request.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::cli {
namespace {

using std::filesystem::path;

struct CheckOptions {
  ModelOptions model;
  PictureGiven picture;
  CheckArguments arguments;
};

void add_json_of_check(CLI::App& command, CheckOptions& to) {
  option_text("check", "--json");
  const auto take = [&to](const std::vector<std::string>& values) {
    // In "check --json room.obj" the word after --json is the model.
    to.arguments.json_on_stdout = true;
    for (const std::string& value : values) {
      if (path(value).extension() == ".json") {
        to.arguments.json = value;
      } else if (!value.empty()) {
        to.model.models.push_back(value);
      }
    }
  };
  command.add_option_function<std::vector<std::string>>("--json", take)->expected(0, 1'000'000);
}

CheckArguments finish_check(const CheckOptions& options) {
  CheckArguments arguments = options.arguments;
  take_model(options.model, arguments);
  arguments.json_on_stdout = arguments.json_on_stdout && arguments.json.empty();
  require_model(options.model, "check", "");
  const std::string& picture = options.picture.file;
  if (!picture.empty() && !picture.ends_with(".png") && !picture.ends_with(".hdr"))
    throw refusal("--picture", picture, "a name that ends in .png or .hdr");
  arguments.picture = picture_settings(options.picture, "--picture", PictureQuality::draft);
  if (arguments.picture.views.size() > 1) throw UsageError("--view: check --picture takes one view only");
  if (arguments.ambient_distance && picture.empty()) throw UsageError("--ambient-occlusion needs --picture FILE");
  require_distinct(outputs_of(arguments));
  require_not_read(outputs_of(arguments), arguments.models);
  return arguments;
}

InitArguments finish_init(const GivenOptions<InitArguments>& options) {
  InitArguments arguments = options.arguments;
  if (options.model.models.empty() || arguments.output.empty())
    throw UsageError(std::string("init: no ") + (options.model.models.empty() ? "model" : "-o SCENE.toml") +
                     " given\nhint: patchlight init MODEL -o SCENE.toml");
  take_model(options.model, arguments);
  for (const path& model : arguments.models) {
    if (model == "-" || model.extension() == ".toml")
      throw UsageError("init: '" + model.string() + "' is no model file, which a scene file could name");
  }
  require_not_read({{"-o", arguments.output}}, arguments.models);
  return arguments;
}

struct SolveOptions : SolutionOptions {
  ModelOptions model;
};

void add_stored_form_factors(CLI::App& command, SolveArguments& to) {
  add_name(command, "--form-factors", to.form_factors, "the name of a folder");
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

SolveArguments finish_solve(SolveOptions& options) {
  require_model(options.model, "solve", " -o RESULT.vtp");
  take_model(options.model, options.arguments);
  SolveArguments arguments = with_solution(options, "solve");
  const bool in_series = !arguments.series.empty();
  Storage& storage = arguments.request.assembly.storage;
  if (in_series && storage == Storage::automatic) storage = Storage::tiles;
  arguments.request = with_fitting_solver(std::move(arguments.request), arguments.solver_given || in_series);
  require_checkpoint_of_rays(arguments);
  check(arguments.request, {.form_factors = !arguments.form_factors.empty()});
  return arguments;
}

SolveArguments finish_relight(SolveOptions& options) {
  if (options.arguments.form_factors.empty())
    throw UsageError("relight: no folder given\nhint: patchlight relight FOLDER -o RESULT.vtp");
  take_model(options.model, options.arguments);
  SolveArguments arguments = with_solution(options, "relight");
  check(arguments.request, {.form_factors = true});
  return arguments;
}

PlanArguments finish_plan(const GivenOptions<PlanArguments>& options) {
  require_model(options.model, "plan", "");
  PlanArguments arguments = options.arguments;
  take_model(options.model, arguments);
  arguments.request = with_fitting_solver(std::move(arguments.request), false);
  check(arguments.request);
  require_not_read({{"--json", arguments.json}}, arguments.models);
  return arguments;
}

struct RenderOptionsGiven {
  ModelOptions model;
  PictureGiven picture;
  RenderArguments arguments;
};

std::string solution_named(const std::string& option, const std::string& text) {
  if (text.ends_with(".vtu"))
    throw UsageError(option + ": '" + text +
                     "' is a grid (.vtu), which lacks facts that images need\n"
                     "hint: solve with -o RESULT.vtp and give that file");
  if (!text.ends_with(".vtp")) throw refusal(option, text, "a name that ends in .vtp");
  return text;
}

// The error for a missing solution, which may be among the models.
std::string without_solution(const std::vector<std::string>& models) {
  const auto is_result = [](const std::string& file) { return in_lower_case(file).ends_with(".vtp"); };
  const auto result = std::find_if(models.begin(), models.end(), is_result);
  if (result == models.end()) return "no solution given\nhint: --solution RESULT.vtp, from patchlight solve";
  return *result + " is a solution, not a model\nhint: patchlight render MODEL --solution " + shell_word(*result) +
         " -o VIEW.png";
}

void require_consistent(const RenderOptionsGiven& options) {
  const RenderArguments& asked = options.arguments;
  const std::string& picture = options.picture.file;
  require_model(options.model, "render", " --solution RESULT.vtp -o VIEW.png");
  if (asked.solution.empty()) throw UsageError("render: " + without_solution(options.model.models));
  if (picture.empty() && asked.observers.empty() && asked.lightmap.folder.empty())
    throw UsageError("render: nothing would be written\nhint: -o VIEW.png, --observers FILE.csv or --lightmap FOLDER");
  if (picture.empty() && !asked.page.empty())
    throw UsageError("--html: the page shows the images of render, and there is none\nhint: -o VIEW.png");
  if (!asked.difference.empty() && (!picture.ends_with(".png") || options.picture.colors))
    throw UsageError("--difference is an image in natural colors\nhint: -o FILE.png, without --false-color");
}

RenderArguments finish_render(const RenderOptionsGiven& options) {
  require_consistent(options);
  RenderArguments arguments = options.arguments;
  take_model(options.model, arguments);
  require_lightmap(arguments.lightmap);
  PictureGiven given = options.picture;
  given.for_observers = !arguments.observers.empty();
  arguments.picture = picture_settings(given, "-o", PictureQuality::final);
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
  add_sides_option(command, to->arguments.sides);
  add_flag(command, "--all", to->arguments.all);
  add_json_of_check(command, *to);
  add_ending(command, "--problems", to->arguments.problems, ".vtp");
  add(command, "--picture", [&to = *to](const std::string& text) { to.picture.file = text; });
  add_view_options(command, to->picture);
  add(command, "--ambient-occlusion", to->arguments.ambient_distance, length);
  return [to] { return finish_check(*to); };
}

Finish add_init(CLI::App& tool) {
  auto to = std::make_shared<GivenOptions<InitArguments>>();
  CLI::App& command = *tool.add_subcommand("init");
  add_file_options(command, to->model);
  add_ending(command, "-o,--output", to->arguments.output, ".toml");
  return [to] { return finish_init(*to); };
}

Finish add_solve(CLI::App& tool) {
  auto to = std::make_shared<SolveOptions>();
  CLI::App& command = *tool.add_subcommand("solve");
  Request& request = to->arguments.request;
  add_run_options(command, to->model, request, effects_but({}));
  add_output_options(command, *to);
  add_graded_option(command, request);
  add_accuracy_options(command, request);
  add_method_options(command, request);
  add_stored_form_factors(command, to->arguments);
  add_solver_options(command, to->arguments);
  add_verbosity_options(command, to->arguments);
  return [to] { return finish_solve(*to); };
}

Finish add_relight(CLI::App& tool) {
  auto to = std::make_shared<SolveOptions>();
  CLI::App& command = *tool.add_subcommand("relight");
  Request& request = to->arguments.request;
  add(command, "FOLDER", [&to = *to](const std::string& text) { to.arguments.form_factors = text; });
  add_light_options(command, to->model);
  add_effect_options(command, request,
                     effects_but({Effect::occlusion, Effect::reach, Effect::backs, Effect::textures}));
  add_output_options(command, *to);
  add_solver_options(command, to->arguments);
  add_machine_options(command, request);
  add_verbosity_options(command, to->arguments);
  return [to] { return finish_relight(*to); };
}

Finish add_plan(CLI::App& tool) {
  auto to = std::make_shared<GivenOptions<PlanArguments>>();
  CLI::App& command = *tool.add_subcommand("plan");
  Request& request = to->arguments.request;
  add_run_options(command, to->model, request, effects_but({}));
  add_json_option(command, to->arguments.json);
  add_graded_option(command, request);
  add_accuracy_options(command, request);
  add_method_options(command, request);
  add_closure_option(command, request);
  return [to] { return finish_plan(*to); };
}

Finish add_render(CLI::App& tool) {
  auto to = std::make_shared<RenderOptionsGiven>();
  CLI::App& command = *tool.add_subcommand("render");
  add_model_options(command, to->model);
  add(command, "--solution", to->arguments.solution, solution_named);
  add_name(command, "-o,--output", to->picture.file, "the name of a file");
  add_picture_options(command, to->picture);
  add(command, "--difference", to->arguments.difference, solution_named);
  add_ending(command, "--observers", to->arguments.observers, ".csv");
  add_lightmap_options(command, to->arguments.lightmap);
  add_page_option(command, to->arguments.page);
  add_threads_option(command, to->arguments.threads);
  add_quiet_option(command, to->arguments.quiet);
  return [to] { return finish_render(*to); };
}

}  // namespace patchlight::cli
