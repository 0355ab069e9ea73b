#include "cli/solve_options.h"

#include "cli/accuracy_options.h"
#include "cli/add_option.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"
#include "cli/solution_options.h"

#include <string>

namespace patchlight::cli {

struct SolveOptions {
  ModelOptions model;
  MeshOptions mesh;
  SolutionOptions solution;
  std::string form_factors;
};

namespace {

// Rows on demand serve a solver that asks for few of them, and cannot be closed, as that takes all.
void require_solver_of_rows(const SolveArguments& arguments) {
  const Request& request = arguments.request;
  if (keeps_entries(request.storage)) return;
  if (!is_shooting(request.solver)) throw UsageError("--on-demand needs --solver progressive or overshooting");
  const char* const other = !arguments.form_factors.empty()             ? "--form-factors"
                            : !request.close                            ? "--no-closure"
                            : request.estimator != Estimator::automatic ? "--estimator"
                                                                        : nullptr;
  if (other == nullptr) return;
  throw UsageError(std::string(other) + " and --on-demand exclude each other; give one of them");
}

}  // namespace

std::shared_ptr<SolveOptions> add_solve(CLI::App& tool) {
  auto options = std::make_shared<SolveOptions>();
  SolveOptions& to = *options;
  CLI::App& command = *tool.add_subcommand("solve", "solves a model: interreflected light on all its surfaces");
  add_model_options(command, to.model);
  add_sides_option(command, to.mesh);
  add_output_options(command, to.solution);
  add_patch_options(command, to.mesh);
  add_accuracy_options(command, to.mesh.request);
  add(command, "--form-factors", "FOLDER",
      "what patchlight form-factors has written for this model:\ntaken from there, with the options of then; "
      "default:\ncomputed",
      [&to](const std::string& text) {
        if (text.empty()) throw refusal("--form-factors", text, "the name of a folder");
        to.form_factors = text;
      });
  command.add_flag_callback(
      "--on-demand", [&to] { to.mesh.request.storage = Storage::on_demand; },
      "no matrix: form factors are computed whenever the solver asks for\nthem, and not closed; little memory, a first "
      "picture early;\nneeds --solver progressive or overshooting; default: all are\ncomputed and kept");
  add_effect_options(command, to.mesh.request);
  add_solver_options(command, to.solution);
  add_sampling_options(command, to.mesh);
  add_machine_options(command, to.mesh.request);
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
  arguments.request = mesh_request(options.mesh, options.model.metres_per_unit);
  arguments.form_factors = options.form_factors;
  arguments = with_solution(std::move(arguments), "solve", options.solution);
  require_solver_of_rows(arguments);
  require_consistent_effects(arguments.request, arguments.form_factors.string());
  require_error_bars_possible(arguments.request, arguments.form_factors.string());
  return arguments;
}

}  // namespace patchlight::cli
