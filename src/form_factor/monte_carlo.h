#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// The sample points of one pair of patches, uniform in the unit hypercube: a digitally shifted net. Coordinates 0 and
/// 1 belong to the first patch, 2 and 3 to the second.
struct SampleSet {
  const std::uint32_t* net = nullptr;    ///< coordinate d of sample k, times 2^32, is at [d * stride + k]
  std::size_t stride = 0;                ///< number of samples
  std::array<std::uint32_t, 4> shift{};  ///< of each coordinate; to be added without carry
};

/// What a coordinate of a net is after the shift: strictly between 0 and 1, with 24 bits.
inline float shifted(std::uint32_t net, std::uint32_t shift) {
  return (static_cast<float>(static_cast<std::int32_t>((net ^ shift) >> 9)) + 0.5F) * 0x1p-23F;
}

/// Pairs of points on two patches, from scrambled Sobol sequences kept in a table. Which scramble a pair of patches
/// uses, and how it is shifted, follows from the seed and the two patches' keys alone. Pairs that have the scramble in
/// common do not err alike, as their shifts differ.
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
  std::vector<std::uint32_t> table_;
};

/// The geometry term G = cos cos' / (pi r^2) in 1/m^2 between two differential areas; 0 when one is behind the other.
double geometry_term(const Point& x, const Vector& normal_x, const Point& y, const Vector& normal_y);

}  // namespace patchlight
