#include "output/accuracy_json.h"

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;

Json errors_of(const AccuracyStep& step) {
  return {{"mesh", step.mesh},
          {"form_factor", step.form_factor},
          {"solver", step.solver},
          {"total", step.total},
          {"display", step.display}};
}

}  // namespace

Json relative_errors(const Simulation& simulation) {
  if (simulation.accuracy.empty()) return nullptr;
  return errors_of(simulation.accuracy.back());
}

Json relative_errors_by_space(const Simulation& simulation) {
  if (simulation.spaces.empty()) return nullptr;
  Json spaces;
  for (const SpaceErrors& space : simulation.spaces) {
    spaces[space.space] = errors_of(space.errors);
    spaces[space.space]["patches"] = space.errors.patches;
  }
  return spaces;
}

Json accuracy_steps(const Simulation& simulation) {
  Json steps = Json::array();
  for (const AccuracyStep& step : simulation.accuracy) {
    Json part = {{"patches", step.patches}, {"new_patches", step.new_patches}, {"samples", step.samples}};
    part.update(errors_of(step));
    part["seconds"] = step.seconds;
    part["cpu_seconds"] = step.cpu_seconds;
    steps.push_back(std::move(part));
  }
  return steps;
}

}  // namespace patchlight
