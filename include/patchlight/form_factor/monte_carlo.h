#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include <cstdint>
#include <vector>

namespace patchlight {

/// The sample points of one pair of patches: coordinate d of sample k is at [d * stride + k]. Coordinates 0 and 1
/// belong to the first patch, 2 and 3 to the second.
struct SampleSet {
  const float* square = nullptr;    ///< uniform in the unit square
  const float* triangle = nullptr;  ///< uniform barycentric weights
  std::size_t stride = 0;
};

/// Pairs of points on two patches, from scrambled Sobol sequences kept in a table. Which scramble a pair of patches
/// uses follows from the seed and the two patches' keys alone.
class SampleTable {
 public:
  /// `samples` is the largest number of samples of one pair of patches.
  SampleTable(std::uint32_t samples, std::uint64_t seed);

  /// `replicate` chooses among independent sets of one pair: sets of different replicates below 16 differ.
  SampleSet of_pair(std::uint32_t first_key, std::uint32_t second_key, std::uint32_t replicate = 0) const;

 private:
  std::uint32_t samples_;
  std::uint32_t scrambles_;
  std::uint64_t seed_;
  std::vector<float> table_;
};

/// The geometry term G = cos cos' / (pi r^2) in 1/m^2 between two differential areas; 0 when one is behind the other.
double geometry_term(const Point& x, const Vector& normal_x, const Point& y, const Vector& normal_y);

}  // namespace patchlight
