#pragma once

#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"

#include "lighting/direct_irradiance.h"
#include "lighting/lighting.h"
#include "lighting/mirror_paths.h"

#include <span>

namespace patchlight {

/// The paths of light from lamps, luminaires, sun and sky via the mirrors and clear faces of a scene.
struct Mirrors {
  MirrorPaths paths;
  SpecularAim aim;
  const Occluder& occluder;  ///< of all faces

  /// Chains of the lighting's luminaires and sun, and of the strongest emitting polygons.
  Mirrors(const Scene& scene, const Tracing& tracing, const Lighting& lighting);
};

/// Mean irradiance of every patch by light of luminaires, sun, sky and these lamps that gets there by way of mirrors
/// and clear faces, where reflections are followed: over the chains of Lighting::mirrors, or along random paths
/// for the sky. `lighting` must have mirrors; it is sampled as direct_irradiance() samples.
/// docs/theory/panes-mirrors-sheets.md. O(patches x chains x lights x mirrored_samples). \throws Canceled.
DirectIrradiance mirrored_irradiance(const Lighting& lighting, std::span<const LampFace> lamps, const PatchMesh& mesh,
                                     const LightingOptions& options = {}, const Observer& observer = {});

/// Irradiance at points, with 16 times as many samples.
DirectIrradiance mirrored_irradiance(const Lighting& lighting, std::span<const LampFace> lamps,
                                     std::span<const SurfacePoint> points, const LightingOptions& options = {},
                                     const Observer& observer = {});

}  // namespace patchlight
