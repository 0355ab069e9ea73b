#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/sensor.h"
#include "patchlight/visibility/occluder.h"

#include <cstdint>
#include <span>

namespace patchlight {

struct GatherOptions {
  int probes = 4;            ///< shadow rays per patch seen
  int samples = 64;          ///< when these disagree
  int emitter_samples = 64;  ///< shadow rays per emitting patch
  std::uint64_t seed = 1;
};

/// Irradiance at points (rows) per band (columns), W/m^2.
struct GatheredIrradiance {
  Field irradiance;
  Field standard_error;  ///< of the shadow rays; the radiosities are taken as they are
};

/// Irradiance at points by gathering the solved radiosity: every patch by its closed-form form factor times the share
/// of it that shadow rays reach, emitting patches (any band of `exitance` above 0) with more rays than the others. The
/// standard error adds up half the difference of what the two halves of a patch's shadow rays say, in squares over the
/// patches, which have random shifts of their own. As the rays are stratified, and both halves together better than
/// each, it is rather too large; patches whose first rays agree count as certain. O(points x patches). \throws
/// Cancelled.
GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const FieldView& exitance,
                                     const Occluder& occluder, std::span<const Sensor> sensors,
                                     const GatherOptions& options = {}, const Observer& observer = {});

}  // namespace patchlight
