#include "cli/solve_options.h"

#include "cli/accuracy_options.h"
#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/option_names.h"
#include "cli/parse_value.h"
#include "cli/solution_options.h"
#include "cli/storage_option.h"
#include "plan/check_request.h"

#include <string>
#include <utility>

namespace patchlight::cli {

struct SolveOptions {
  ModelOptions model;
  RequestGiven request;
  SolutionOptions solution;
  std::string form_factors;
  std::string checkpoint;
};

namespace {

void add_checkpoint_option(CLI::App& command, SolveOptions& options) {
  command.option_defaults()->group("Form factors and equations");
  add(command, "--checkpoint", "FOLDER",
      "with --method rays, which it implies: rows are kept there while\nthe run lasts, so that one that is killed "
      "goes on where it was\nwhen it is started again; default: nothing is kept",
      [&options](const std::string& text) {
        if (text.empty()) throw refusal("--checkpoint", text, "the name of a folder");
        options.checkpoint = text;
        if (options.request.assembly.storage == Storage::automatic) options.request.assembly.storage = Storage::rays;
      });
}

void require_checkpoint_of_rays(const SolveArguments& arguments) {
  if (arguments.checkpoint.empty()) return;
  if (!arguments.form_factors.empty())
    throw UsageError("--checkpoint and --form-factors exclude each other: rows that are stored are not traced");
  if (arguments.request.assembly.storage != Storage::rays)
    throw UsageError(with_option_names("--checkpoint keeps rows of rays; found assembly.storage=" +
                                       std::string(name_of(arguments.request.assembly.storage)) +
                                       ", expected --method rays"));
}

}  // namespace

std::shared_ptr<SolveOptions> add_solve(CLI::App& tool) {
  auto options = std::make_shared<SolveOptions>();
  SolveOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("solve", "solves a model: interreflected light on all its surfaces");
  add_model_options(command, to.model);
  add_sides_option(command, to.request);
  add_output_options(command, to.solution);
  add_patch_options(command, to.request);
  add_graded_option(command, to.request);
  add_accuracy_options(command, to.request);
  command.option_defaults()->group("Form factors and equations");
  add(command, "--form-factors", "FOLDER",
      "what patchlight form-factors has written for this model:\ntaken from there, with the options of then; "
      "default:\ncomputed",
      [&to](const std::string& text) {
        if (text.empty()) throw refusal("--form-factors", text, "the name of a folder");
        to.form_factors = text;
      });
  add_storage_options(command, to.request);
  add_checkpoint_option(command, to);
  add_effect_options(command, to.request, effects_but({}));
  add_solver_options(command, to.solution, to.request);
  add_sampling_options(command, to.request);
  add_machine_options(command, to.request);
  add_verbosity_options(command, to.solution);
  return options;
}

SolveArguments finish_solve(const SolveOptions& options) {
  if (options.model.models.empty()) {
    throw UsageError("solve: found no model; expected: patchlight solve MODEL -o RESULT.vtp");
  }
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

}  // namespace patchlight::cli
