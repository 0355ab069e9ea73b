#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/mesh/patch_mesh.h"

#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

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
  std::array<std::uint32_t, 4> shift{};  ///< of each coordinate; added without carry
};

/// A coordinate of a net after the shift: strictly between 0 and 1, with 24 bits.
inline float shifted(std::uint32_t net, std::uint32_t shift) {
  return (static_cast<float>(static_cast<std::int32_t>((net ^ shift) >> 9)) + 0.5F) * 0x1p-23F;
}

/// Pairs of points on two patches, from a table of scrambled Sobol sequences. The seed and the keys of the two patches
/// choose the scramble of a pair and its shift. Pairs with the same scramble have different errors, because their
/// shifts differ.
class SampleTable {
 public:
  /// `samples` is the largest number of samples of one pair of patches.
  SampleTable(std::uint32_t samples, std::uint64_t seed);

  /// `replicate` chooses one of 16 independent sets of a pair.
  SampleSet of_pair(std::uint32_t first_key, std::uint32_t second_key, std::uint32_t replicate = 0) const;

 private:
  std::uint32_t samples_;
  std::uint32_t scrambles_;
  std::uint64_t seed_;
  std::vector<std::uint32_t> table_;
};

/// The geometry term G = cos cos' / (pi r^2) in 1/m^2 between two differential areas; 0 when one is behind the other.
double geometry_term(const Point& x, const Vector& normal_x, const Point& y, const Vector& normal_y);

/// A patch as it is sampled, in the occluder's frame and single precision: its points are
/// origin + u along_u + v along_v + u v twist, with (u, v) uniform in the unit square or, for a triangle, barycentric.
struct SampledPatch {
  std::array<float, 3> origin, along_u, along_v, twist, normal;
  std::array<float, 3> density;  ///< weight of a sample: density[0] + u density[1] + v density[2], on average 1
  PolygonIndex polygon = no_polygon;
  bool is_triangle = false;
};

/// The patch of a shape, whose polygon is `polygon`, in the frame of an occluder.
SampledPatch sampled_patch(const PatchShape& shape, PolygonIndex polygon, const TracingFrame& frame);

/// Up to sixteen shadow rays, and the contribution of each to the mean geometry term of its pair.
struct PairSamples {
  ShadowPacket rays;
  alignas(64) std::array<float, ShadowPacket::size> weight;  ///< times the two areas: exchange area
};

/// Fills `count` lanes, starting at `lane`, with the samples `first` to first + count - 1 of a pair of patches. count
/// is 2, 4, 8 or 16. Weights are geometry terms in 1/m^2.
void add_samples(PairSamples& samples, int lane, int count, const SampledPatch& from, const SampledPatch& to,
                 const SampleSet& set, std::uint32_t first, double scale);

}  // namespace patchlight
