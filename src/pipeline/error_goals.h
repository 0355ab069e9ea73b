#pragma once

#include "pipeline/run.h"

namespace patchlight {

/// Errors are brought this much lower than they have to be, as they are estimates.
inline constexpr double error_margin = 1.25;

/// What one error may be when the others are as they are: what they leave, but no less than its share.
double allowed(double accuracy, double share, double others);

/// Shadow rays of a pair, or rays of a patch, more than which are not worth their time.
int most_samples(const Plan& plan);

/// The number of patches for which the mesh error is expected to be `factor` times smaller.
double patches_for(double patches, double factor);

/// By what factor the error of the mesh has to fall for an accuracy, and that of shadow rays towards luminaires, sun
/// and sky, which are as many for every patch. `step` has the errors of the solved mesh.
double mesh_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy);

/// The factor by which the noise of samples has to fall.
double noise_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy);

/// The samples that the next mesh takes for its pairs. Noise falls as one over the root of samples and patches: samples
/// for those patches that the mesh will need. As long as that is far off, the usual number does; and where the next
/// mesh goes by rows of rays.
int samples_for(const SolvedMesh& solved, const AccuracyStep& step, double accuracy, const Plan& plan);

}  // namespace patchlight
