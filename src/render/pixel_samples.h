#pragma once

#include <array>
#include <cstdint>

namespace patchlight {

/// Point `index` of a four-dimensional Owen-scrambled Sobol sequence that belongs to `seed`, in shuffled order: any
/// aligned block of a power of two of its points is stratified, and sequences of different seeds have nothing to do
/// with each other. Repeats after 4,096. Burley 2020, Practical Hash-based Owen Scrambling, section 5.
std::array<double, 4> pixel_sample(std::uint32_t index, std::uint32_t seed);

/// Its first two coordinates, in half the time.
std::array<double, 2> pixel_sample_2d(std::uint32_t index, std::uint32_t seed);

/// A number of (0, 1) moved to the density 1 - |x| of (-1, 1): a pixel's place under the tent filter, so that each of
/// its samples counts alike (Ernst, Stamminger and Greiner 2006, Filter Importance Sampling).
double tent(double u);

}  // namespace patchlight
