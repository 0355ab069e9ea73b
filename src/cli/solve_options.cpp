#include "cli/solve_options.h"

#include "cli/accuracy_options.h"
#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"
#include "cli/solution_options.h"
#include "plan/check_request.h"

#include <string>

namespace patchlight::cli {

struct SolveOptions {
  ModelOptions model;
  Request request;  // with the edge of patches in model units
  SolutionOptions solution;
  std::string form_factors;
};

namespace {

Storage storage_named(const std::string& text) {
  if (text == "auto") return Storage::automatic;
  if (text == "tiles") return Storage::tiles;
  if (text == "rays") return Storage::rays;
  if (text == "on-demand") return Storage::on_demand;
  throw refusal("--storage", text, "auto, tiles, rays or on-demand");
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
  add_accuracy_options(command, to.request);
  add(command, "--form-factors", "FOLDER",
      "what patchlight form-factors has written for this model:\ntaken from there, with the options of then; "
      "default:\ncomputed",
      [&to](const std::string& text) {
        if (text.empty()) throw refusal("--form-factors", text, "the name of a folder");
        to.form_factors = text;
      });
  command.add_flag_callback(
      "--on-demand", [&to] { to.request.assembly.storage = Storage::on_demand; },
      "no matrix: form factors are computed whenever the solver asks for\nthem, and not closed; little memory, a first "
      "picture early;\nneeds --solver progressive or overshooting; default: all are\ncomputed and kept");
  add(command, "--storage", "auto|tiles|rays|on-demand",
      "how form factors are kept: of all pairs of patches; sparse rows of\nwhat some rays from each patch meet, for "
      "many patches, with a\nstandard error for each; or not at all, as --on-demand; default\nauto: pairs, and rays "
      "for more than 10,000 patches or where the\nmemory is too small; always pairs with --solver, "
      "--series,\n--error-bars, "
      "--accuracy, --time, --estimator, --no-closure,\n--force closure and --form-factors",
      [&to](const std::string& text) { to.request.assembly.storage = storage_named(text); });
  add_effect_options(command, to.request);
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
  arguments.request = in_metres(options.request, options.model.metres_per_unit);
  arguments.form_factors = options.form_factors;
  arguments = with_solution(std::move(arguments), "solve", options.solution);
  Request& request = arguments.request;
  const bool solver_given = options.solution.solver_given || !options.solution.series.empty();
  if (request.assembly.storage == Storage::rays && !solver_given) request.solver.solver = Solver::gmres;
  if (request.assembly.storage == Storage::automatic && solver_given) request.assembly.storage = Storage::tiles;
  check(arguments.request, {.form_factors = !arguments.form_factors.empty()});
  return arguments;
}

}  // namespace patchlight::cli
