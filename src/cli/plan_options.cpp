#include "cli/plan_options.h"

#include "cli/accuracy_options.h"
#include "cli/add_option.h"
#include "cli/distinct_files.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/parse_value.h"
#include "cli/storage_option.h"
#include "plan/check_request.h"

#include <filesystem>
#include <string>

namespace patchlight::cli {

struct PlanOptions {
  ModelOptions model;
  RequestGiven request;
  std::string json;
};

std::shared_ptr<PlanOptions> add_plan(CLI::App& tool) {
  auto options = std::make_shared<PlanOptions>();
  PlanOptions& to = *options;
  CLI::App& command =
      *tool.add_subcommand("plan", "tells what a solve would simulate and leave out, why, and what it would cost");
  add_model_options(command, to.model);
  add_sides_option(command, to.request);
  command.option_defaults()->group("Results");
  add(command, "--json", "FILE", "the same as JSON (.json)", [&to](const std::string& text) {
    if (!text.ends_with(".json")) throw refusal("--json", text, "a name that ends in .json");
    to.json = text;
  });
  add_patch_options(command, to.request);
  add_graded_option(command, to.request);
  add_accuracy_options(command, to.request);
  add_storage_options(command, to.request);
  add_closure_option(command, to.request);
  add_effect_options(command, to.request, effects_but({}));
  add_sampling_options(command, to.request);
  add_machine_options(command, to.request);
  return options;
}

PlanArguments finish_plan(const PlanOptions& options) {
  if (options.model.models.empty()) throw UsageError("plan: found no model; expected: patchlight plan MODEL");
  PlanArguments arguments;
  arguments.models = model_files(options.model);
  arguments.read = read_options(options.model);
  arguments.request = with_fitting_solver(in_metres(options.request, options.model.metres_per_unit.value_or(1)), false);
  arguments.json = options.json;
  check(arguments.request);
  require_not_read({{"--json", arguments.json}}, arguments.models);
  return arguments;
}

}  // namespace patchlight::cli
