#pragma once

#include "patchlight/gather/gather.h"

#include "lighting/mirror_paths.h"

namespace patchlight {

/// Sampling of the light that sensors see in mirrors.
struct MirroredGatherOptions {
  int rays = 4096;  ///< directions from each sensor, a power of two
  std::uint64_t seed = 1;
  RadiosityErrors errors = {};
};

/// Irradiance at points by radiosity that they see in mirrors and clear faces: MirrorView's rays, each of which goes on
/// as light does between patches. In most_replicates independent parts, whose scatter is the standard error. Patches'
/// own errors count as their light does. O(points x rays). \throws Canceled.
GatheredIrradiance gather_mirrored(const PatchMesh& mesh, const FieldView& radiosity, const MirrorView& view,
                                   const Occluder& occluder, std::span<const Sensor> sensors,
                                   const MirroredGatherOptions& options, const Observer& observer = {});

}  // namespace patchlight
