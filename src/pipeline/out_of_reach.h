#pragma once

#include "patchlight/simulate.h"

#include <cstddef>
#include <optional>
#include <span>

namespace patchlight {

/// What an accuracy takes.
struct Needed {
  double patches = 0;
  double reachable = 0;  ///< the error with as many patches as fit
};

/// Once three meshes have told how the error falls with the number of patches: set where far more are needed for the
/// accuracy than fit. Never by rows of rays, which err by their rays as well.
std::optional<Needed> out_of_reach(const Plan& plan, std::span<const AccuracyStep> steps);

/// \throws MemoryError with the memory that so many patches take, and the error that is expected with what may be
/// taken.
[[noreturn]] void refuse(const Plan& plan, const Needed& needed);

}  // namespace patchlight
