#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "form_factor/pair_samples.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace patchlight {

class Occluder;

/// A side of a polygon with uniform emission.
struct EmitterSide {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;
};

/// The number of triangles and convex quadrilaterals in a side.
std::size_t piece_count(const Scene& scene, const EmitterSide& emitter);

/// One value per patch (row) and emitter (column).
using EmitterValues = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Form factors from patches to whole emitters, as means over the whole patch, by two independent halves of shadow
/// rays.
struct EmitterFactors {
  std::array<EmitterValues, 2> halves;
  EmitterValues standard_error;  ///< of the mean of both
  std::uint64_t shadow_rays = 0;
};

/// How emitters are sampled.
struct EmitterSampling {
  int rays = 64;
  std::uint64_t seed = 1;
};

/// Form factors between each patch and each piece of an emitter. The closed form without occluders applies if all rays
/// are free, 0 if all are blocked; else formula (5) of docs/theory/occluded-form-factors.md. Each half uses a quarter
/// of `rays` per pair, 16 at least, and four times as many if those of the **other** half disagree. The number does not
/// depend on its own rays, so the estimate is unbiased. Standard errors are pooled over pairs with the same visible
/// share. The same bits for any number of threads. \throws Canceled.
EmitterFactors emitter_factors(const Scene& scene, const PatchMesh& mesh, const Occluder& occluder,
                               std::span<const EmitterSide> emitters, const EmitterSampling& sampling,
                               const Observer& observer = {});

}  // namespace patchlight
