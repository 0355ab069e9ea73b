#include "cli/relight_options.h"

#include "cli/daylight_options.h"
#include "cli/effect_options.h"
#include "cli/mesh_options.h"
#include "cli/model_options.h"
#include "cli/solution_options.h"
#include "plan/check_request.h"

#include <optional>
#include <string>
#include <vector>

namespace patchlight::cli {

struct RelightOptions {
  std::string folder;
  std::vector<std::string> settings;
  std::optional<Vector> up;
  DaylightSetting daylight;
  Request request;
  SolutionOptions solution;
};

std::shared_ptr<RelightOptions> add_relight(CLI::App& tool) {
  auto options = std::make_shared<RelightOptions>();
  RelightOptions& to = *options;
  CLI::App& command =
      *tool.add_subcommand("relight", "solves with stored form factors, after a change of materials and lamps");
  command
      .add_option("FOLDER", to.folder,
                  "what patchlight form-factors has written; the model's\nfiles need not be there any more")
      ->option_text(" ");
  add_set_option(command, to.settings);
  add_up_option(command, to.up);
  add_daylight_options(command, to.daylight);
  add_effect_options(command, to.request,
                     effects_but({Effect::occlusion, Effect::reach, Effect::backs, Effect::textures}));
  add_output_options(command, to.solution);
  add_solver_options(command, to.solution, to.request);
  add_machine_options(command, to.request);
  add_verbosity_options(command, to.solution);
  return options;
}

SolveArguments finish_relight(const RelightOptions& options) {
  if (options.folder.empty()) {
    throw UsageError("relight: found no folder; expected: patchlight relight FOLDER -o RESULT.vtp");
  }
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

}  // namespace patchlight::cli
