#pragma once

#include "form_factor/monte_carlo.h"
#include "form_factor/patch_shape.h"
#include "visibility/occluder.h"

#include <array>
#include <cstdint>

namespace patchlight {

/// A patch as it is sampled, in the occluder's frame and single precision: its points are
/// origin + u along_u + v along_v + u v twist, with (u, v) uniform in the unit square or, for a triangle, barycentric.
struct SampledPatch {
  std::array<float, 3> origin, along_u, along_v, twist, normal;
  std::array<float, 3> density;  ///< weight of a sample: density[0] + u density[1] + v density[2], 1 in the mean
  PolygonIndex polygon = no_polygon;
  bool is_triangle = false;
};

/// The patch of a shape, whose polygon is `polygon`, in the frame of an occluder.
SampledPatch sampled_patch(const PatchShape& shape, PolygonIndex polygon, const TracingFrame& frame);

/// The samples of up to sixteen shadow rays and what each contributes to its pair's mean geometry term.
struct PairSamples {
  ShadowPacket rays;
  alignas(64) std::array<float, ShadowPacket::size> weight;  ///< times the two areas: exchange area
};

/// Fills `count` lanes from `lane` on with the samples `first` to first + count - 1 of a pair of patches; count is 2,
/// 4, 8 or 16. Weights are geometry terms in 1/m^2.
void add_samples(PairSamples& samples, int lane, int count, const SampledPatch& from, const SampledPatch& to,
                 const SampleSet& set, std::uint32_t first, double scale);

}  // namespace patchlight
