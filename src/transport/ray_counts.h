#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Rays of a patch in each of two halves: between these, and a power of two.
inline constexpr std::uint32_t fewest_rays = 8;
inline constexpr std::uint32_t most_rays = 4096;

/// How many rays each patch takes in each of two halves, so that the mean over the patches of both together is about
/// `mean`: in proportion to its area to the power 0.4, rounded to powers of two. Where patches have one size, all have
/// one number, which is then up to 1.42 times more or less than asked for. `areas` are those of the patches, or others
/// in proportion to which patches matter.
std::vector<std::uint32_t> ray_counts(std::span<const double> areas, int mean);

}  // namespace patchlight
