#pragma once

#include "patchlight/simulate.h"

#include "base/parallel.h"

#include <algorithm>
#include <vector>

namespace patchlight {

/// Notes what each stage costs, all its rounds together.
class StageClock {
 public:
  /// Ends a stage; the next one begins.
  void finish(Stage stage) {
    auto of_stage = std::find_if(costs_.begin(), costs_.end(), [&](const StageCost& c) { return c.stage == stage; });
    if (of_stage == costs_.end()) of_stage = costs_.insert(of_stage, {stage, 0, 0});
    of_stage->seconds += wall_seconds() - wall_;
    of_stage->cpu_seconds += cpu_seconds() - cpu_;
    wall_ = wall_seconds();
    cpu_ = cpu_seconds();
  }
  const std::vector<StageCost>& costs() const { return costs_; }

 private:
  double wall_ = wall_seconds();
  double cpu_ = cpu_seconds();
  std::vector<StageCost> costs_;
};

}  // namespace patchlight
