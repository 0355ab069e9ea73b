#pragma once

#include "patchlight/base/progress.h"

namespace patchlight {

/// Tells an observer, which is copied, of a part of a stage as the fractions from one to another of it.
Observer part_of_stage(const Observer& observer, double from, double to);

}  // namespace patchlight
