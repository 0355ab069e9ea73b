#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "lighting/lighting.h"
#include "lighting/sky_coefficients.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The sunlight of a patch or a point, per position of the sun (row) and receiver (column), of one band.
using SparseSunlight = Eigen::SparseMatrix<float, Eigen::RowMajor>;

/// The scene that lies in the way of the suns.
struct SunWays {
  const Lighting& lighting;  ///< of any sky
  const Scene& scene;
  const Tracing& tracing;
};

/// The irradiance at points by a normal irradiance of 1 from each sun (row), per band: straight through panes, and over
/// mirrors where reflections are followed. O(points x suns x chains of mirrors). \throws Canceled.
std::vector<Eigen::MatrixXf> sunlight_at(const SunWays& ways, std::span<const SurfacePoint> points,
                                         std::span<const Vector> suns, const Observer& observer);

/// How sunlight on patches is found.
struct SunSampling {
  std::span<const std::uint8_t> is_important;  ///< per patch: 1 where the outlines of shadows are worth their time
  std::uint64_t seed = 1;
};

/// The same as means over patches, by the outlines of all shadows. Patches that are not important take one ray to each
/// sun. `sky` has the patches' coefficients of `divisions`: only suns near a division from which a patch gets light are
/// examined. Over mirrors all suns of a division have their mean direction. \throws Canceled.
std::vector<SparseSunlight> sunlight_on(const SunWays& ways, const PatchMesh& mesh, const SparseCoefficients& sky,
                                        const SkyDivisions& divisions, std::span<const Vector> suns,
                                        const SunSampling& sampling, const Observer& observer);

}  // namespace patchlight
