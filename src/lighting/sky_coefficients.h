#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "lighting/lighting.h"
#include "lighting/receiver.h"
#include "lighting/sky_divisions.h"

#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// Per receiver (row) and division of the sky (column).
using SparseCoefficients = Eigen::SparseMatrix<float, Eigen::RowMajor>;

/// How many samples a patch of mean size takes; a point takes sixteen times as many.
struct SkyCoefficientOptions {
  int samples = 512;
  std::uint64_t seed = 1;
};

/// The irradiance by a radiance of 1 W/(m^2 sr) in each division of the sky, W/m^2: one matrix for each band.
/// The rays are those of sky_irradiance(), each counted in the division to which it gets, so that one pass serves all
/// divisions, and the sum over these is the irradiance under a uniform sky. Where reflections are followed, light
/// over mirrors and clear faces is added. O(receivers
/// x samples). \throws Canceled.
std::vector<SparseCoefficients> sky_coefficients(const Lighting& lighting, const PatchMesh& mesh,
                                                 const SkyDivisions& divisions, const SkyCoefficientOptions& options,
                                                 const Observer& observer);

/// The same at points.
std::vector<SparseCoefficients> sky_coefficients(const Lighting& lighting, std::span<const SurfacePoint> points,
                                                 const SkyDivisions& divisions, const SkyCoefficientOptions& options,
                                                 const Observer& observer);

}  // namespace patchlight
