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

/// The straight sunlight of a patch or a point, per position of the sun (row) and receiver (column), of one band.
using SparseSunlight = Eigen::SparseMatrix<float, Eigen::RowMajor>;

/// The transmittance of the ways from points to the sun times the cosine, per band: the irradiance by a normal
/// irradiance of 1. Rows are positions of the sun. O(points x suns). \throws Canceled.
std::vector<Eigen::MatrixXf> sunlight_at(const Lighting& lighting, std::span<const SurfacePoint> points,
                                         std::span<const Vector> suns, const Observer& observer);

/// The same as means over patches, by the outlines of all shadows. `visible` has the patches' coefficients of
/// `divisions`, coarse ones: a patch takes part at suns that stand in a division from which it gets light, or beside
/// one.
std::vector<SparseSunlight> sunlight_on(const Lighting& lighting, const Shades& shades, const PatchMesh& mesh,
                                        const SparseCoefficients& visible, const SkyDivisions& divisions,
                                        std::span<const Vector> suns, std::uint64_t seed, const Observer& observer);

}  // namespace patchlight
