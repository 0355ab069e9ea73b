#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "lighting/direct_irradiance.h"
#include "lighting/light_source.h"
#include "lighting/receiver.h"
#include "lighting/sky_irradiance.h"

#include <span>

namespace patchlight {

/// Mean irradiance of every patch by light of all sources and the sky that gets there by way of mirrors and clear
/// faces: over the chains of Lighting::mirrors, which must be there, or along random paths for the sky. Part of
/// direct_irradiance(). O(patches x chains x sources x mirrored_samples). \throws Canceled.
DirectIrradiance irradiance_in_mirrors(const LightSampler& lights, const PatchMesh& mesh,
                                       const LightingOptions& options, const Observer& observer);

/// Irradiance at points, with 16 times as many samples.
DirectIrradiance irradiance_in_mirrors(const LightSampler& lights, std::span<const SurfacePoint> points,
                                       const LightingOptions& options, const Observer& observer);

/// The light of the sky in mirrors and clear faces, ray by ray: that of a receiver by so many points of it, or by as
/// many directions at a point. The sum of weight times radiance is the mean irradiance. The lighting must have mirrors.
void visit_sky_in_mirrors(const Lighting& lighting, const Receiver& receiver, SamplePoints samples, std::uint32_t key,
                          const AtSky& at_sky);

}  // namespace patchlight
