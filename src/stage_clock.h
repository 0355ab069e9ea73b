#pragma once

#include "patchlight/base/parallel.h"
#include "patchlight/simulate.h"

#include <vector>

namespace patchlight {

/// Notes what each stage costs.
class StageClock {
 public:
  /// Ends a stage; the next one begins.
  void finish(Stage stage) {
    costs_.push_back({stage, wall_seconds() - wall_, cpu_seconds() - cpu_});
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
