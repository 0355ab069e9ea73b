#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Pairs of points on two patches, from scrambled Sobol sequences kept in a table. Which scramble a pair of patches
/// uses follows from the seed and the two patches' keys alone.
class SamplePairs {
 public:
  /// `samples` is the largest number of samples of one pair of patches.
  SamplePairs(std::uint32_t samples, std::uint64_t seed);

  /// Coordinates (u, v, u', v') of one sample, in (0, 1).
  const std::array<double, 4>& at(std::uint32_t first_key, std::uint32_t second_key, std::uint32_t sample) const;

 private:
  std::uint32_t samples_;
  std::uint64_t seed_;
  std::vector<std::array<double, 4>> table_;
};

/// The geometry term G = cos cos' / (pi r^2) in 1/m^2 between two differential areas; 0 when one is behind the other.
double geometry_term(const Point& x, const Vector& normal_x, const Point& y, const Vector& normal_y);

}  // namespace patchlight
