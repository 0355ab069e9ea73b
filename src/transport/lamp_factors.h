#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include "form_factor/pair_samples.h"
#include "form_factor/patch_shape.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

class Occluder;

/// A side of a polygon that shines evenly.
struct LampSide {
  PolygonIndex polygon = no_polygon;
  Side side = Side::front;
};

/// The triangles and convex quadrilaterals that a side consists of.
std::size_t piece_count(const Scene& scene, const LampSide& lamp);

/// One value per patch (row) and lamp (column).
using LampValues = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Form factors from patches to lamps as wholes, means over all of the patch, by two independent halves of shadow rays.
struct LampFactors {
  std::array<LampValues, 2> halves;
  LampValues standard_error;  ///< of the mean of both
  std::uint64_t shadow_rays = 0;
};

/// How lamps are sampled.
struct LampSampling {
  int rays = 64;
  std::uint64_t seed = 1;
};

/// Each patch with each piece of a lamp: the closed form without occluders where all rays are free, and 0 where none
/// is; else by formula (5) of docs/theory/occluded-form-factors.md. Each half takes a quarter of `rays` for a pair, 16
/// at least, and four times as many where those of the **other** half disagree: the number does not depend on
/// its own rays, so that it is unbiased. Standard errors are pooled over pairs with the same visible share. The
/// same bits for any number of threads. \throws Cancelled.
LampFactors lamp_factors(const Scene& scene, const PatchMesh& mesh, const Occluder& occluder,
                         std::span<const LampSide> lamps, const LampSampling& sampling, const Observer& observer = {});

}  // namespace patchlight
