#include "pipeline/out_of_reach.h"

#include "patchlight/base/error.h"

#include "accuracy/errors.h"
#include "base/rounded.h"
#include "plan/memory.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace patchlight {

std::optional<Needed> out_of_reach(const Plan& plan, std::span<const AccuracyStep> steps) {
  constexpr double far_more = 2;
  if (steps.size() < 3 || plan.assembly.storage == Storage::rays) return std::nullopt;
  const AccuracyStep& before = steps[steps.size() - 3];
  const AccuracyStep& last = steps.back();
  const double finer = static_cast<double>(last.patches) / before.patches;
  const double order = finer > 1 ? std::log(before.total / last.total) / std::log(finer) : 1;
  const double at_least = std::max(order, mesh_order / 2);
  const double most = patches_that_fit(plan);
  const double needed = last.patches * std::pow(last.total / *plan.accuracy.relative_error, 1 / at_least);
  if (needed <= far_more * most) return std::nullopt;
  return Needed{needed, last.total * std::pow(last.patches / most, at_least)};
}

void refuse(const Plan& plan, const Needed& needed) {
  const auto& [patches, reachable] = needed;
  throw MemoryError("accuracy.relative_error=" + percent(*plan.accuracy.relative_error, 2) + "% needs about " +
                    std::to_string(static_cast<long>(patches)) + " patches and " +
                    gigabytes(memory_needed(static_cast<std::size_t>(patches), plan)) + ", and " +
                    gigabytes(usable_memory(plan.resources)) + " is allowed\nhint: accuracy.relative_error=" +
                    percent(reachable, 2) + "% or more\nhint: or improve a part only: accuracy.interest");
}

}  // namespace patchlight
