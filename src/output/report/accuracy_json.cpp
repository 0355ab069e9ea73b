#include "output/report/accuracy_json.h"

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

Json relative_errors(const std::vector<AccuracyStep>& steps) {
  if (steps.empty()) return nullptr;
  Json part = errors_of(steps.back());
  part["inside"] = steps.back().inside;
  return part;
}

Json relative_errors_by_space(const std::vector<SpaceErrors>& spaces) {
  if (spaces.empty()) return nullptr;
  Json part;
  for (const SpaceErrors& space : spaces) {
    part[space.space] = errors_of(space.errors);
    part[space.space]["patches"] = space.errors.patches;
  }
  return part;
}

Json accuracy_steps(const std::vector<AccuracyStep>& steps) {
  Json parts = Json::array();
  for (const AccuracyStep& step : steps) {
    Json part = {{"patches", step.patches}, {"new_patches", step.new_patches}, {"samples", step.samples}};
    part.update(errors_of(step));
    part["seconds"] = step.seconds;
    part["cpu_seconds"] = step.cpu_seconds;
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace patchlight
