#pragma once

#include "lighting/direct_irradiance.h"
#include "pipeline/run.h"
#include "transport/lamp_factors.h"
#include "transport/ray_transport.h"

#include <vector>

namespace patchlight {

/// What is bright: so many times the mean over the area. Measured; anything from 2 to 16 does.
inline constexpr double bright = 4;

/// What all bands have together, per patch.
inline Eigen::VectorXd summed_over_bands(const Field& field) { return field.rowwise().sum().matrix(); }

/// The lamps whose light is found apart from rows of rays, the strongest first: sides of polygons that emit more than
/// `bright` times the mean over all patches, as many as are 16 triangles and convex quadrilaterals, and 64 where there
/// are mirrors, in which rays over the hemisphere would find the others by luck.
std::vector<LampSide> lamps_apart(const Scene& scene, const PatchMesh& mesh, const RadiosityProblem& problem,
                                  const Tracing& tracing);

/// Their factors, without rows. \throws Cancelled.
RayExchange traced_lamps(const Run& run, const Plan& plan, const PatchMesh& mesh, const RadiosityProblem& problem);

/// The factors of lamps, the patches of a side each, by the clear faces of the run. \throws Cancelled.
LampFactors factors_of_lamps(const std::vector<PatchRange>& lamps, const Run& run, const Plan& plan,
                             const PatchMesh& mesh);

/// With the factors of lamps that are bright, and were dark when the rows were traced; of all lamps where
/// there are clear faces or mirrors, which may have other colours now. \throws Cancelled; InputError when the new ones
/// are too many.
RayExchange with_lamps(RayExchange known, const Run& run, const Plan& plan, const PatchMesh& mesh,
                       const RadiosityProblem& problem);

/// The irradiance of patches by what lamps, the patches of a side each, send over mirrors and clear faces, which their
/// factors do not have; empty where reflections are not followed. \throws Cancelled.
DirectIrradiance lamps_in_mirrors(const Run& run, const LightingOptions& options, const PatchMesh& mesh,
                                  const std::vector<PatchRange>& lamps);

}  // namespace patchlight
