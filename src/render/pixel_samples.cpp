#include "render/pixel_samples.h"

#include "base/sampling.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace patchlight {
namespace {

constexpr std::uint32_t log2_points = 12;
constexpr std::uint32_t point_count = 1U << log2_points;
constexpr std::uint32_t seed_of_points = 0x70697873;

// A scrambled sequence that is scrambled anew is a scrambled sequence.
const std::vector<std::array<std::uint32_t, 4>>& base_points() {
  static const auto all = [] {
    std::vector<std::array<std::uint32_t, 4>> bits(point_count);
    const auto sequence = scrambled_sobol(point_count, seed_of_points);
    for (std::uint32_t k = 0; k < point_count; ++k) {
      for (std::size_t d = 0; d < 4; ++d) bits[k][d] = static_cast<std::uint32_t>(sequence[k][d] * 0x1p32);
    }
    return bits;
  }();
  return all;
}

template <std::size_t count>
std::array<double, count> coordinates(std::uint32_t index, std::uint32_t seed) {
  constexpr std::uint32_t unused = 32 - log2_points;
  const std::uint32_t place = owen_scramble((index % point_count) << unused, hash(seed)) >> unused;
  const std::array<std::uint32_t, 4>& bits = base_points()[place];
  std::array<double, count> sample{};
  for (std::uint32_t d = 0; d < count; ++d)
    sample[d] = (owen_scramble(bits[d], hash(seed + 0x9e3779b9U * (d + 1))) + 0.5) * 0x1p-32;
  return sample;
}

}  // namespace

std::array<double, 4> pixel_sample(std::uint32_t index, std::uint32_t seed) { return coordinates<4>(index, seed); }

std::array<double, 2> pixel_sample_2d(std::uint32_t index, std::uint32_t seed) { return coordinates<2>(index, seed); }

double tent(double u) { return u < 0.5 ? std::sqrt(2 * u) - 1 : 1 - std::sqrt(2 - 2 * u); }

}  // namespace patchlight
