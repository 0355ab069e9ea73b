#pragma once

#include "study/verify.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// What tells random numbers of one purpose from those of another.
struct Drawing {
  std::uint64_t seed = 1;
  std::uint64_t purpose = 0;
};

/// `count` of the indices of these weights, or all above 0 when there are fewer, without replacement: those with the
/// largest log(u) / weight, u uniform in (0, 1) (Efraimidis and Spirakis 2006), in this order.
std::vector<std::uint32_t> drawn_by_weight(std::span<const double> weights, std::size_t count, const Drawing& drawing);

/// VerifyOptions::left_out of the sides that are not kept, with the light that paths find there when all sides are.
/// `mean` is the mean irradiance of the checked patches, W/m^2; reflections as PathOptions has it. \throws Cancelled.
std::vector<LeftOutSide> trace_left_out(const Scene& scene, const KeptSides& kept, const Spectrum& mean,
                                        const VerifyOptions& options, bool follows_reflections,
                                        const Observer& observer);

}  // namespace patchlight
