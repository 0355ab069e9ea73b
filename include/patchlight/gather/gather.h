#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/progress.h"
#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/visibility/occluder.h"

#include <cstdint>
#include <span>

namespace patchlight {

/// A place where irradiance is wanted: metres, unit normal of the receiving side.
struct Sensor {
  Point point;
  Vector normal;
};

struct GatherOptions {
  int probes = 4;            ///< shadow rays per patch seen
  int samples = 64;          ///< when these disagree
  int emitter_samples = 64;  ///< shadow rays per emitting patch
  std::uint64_t seed = 1;
};

/// Irradiance in W/m^2 at points (rows) per band (columns), by gathering the solved radiosity: every patch by its
/// closed-form form factor times the share of it that shadow rays reach, emitting patches (any band of `exitance` above
/// 0) with more rays than the others. O(points x patches). \throws Cancelled.
Field gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const FieldView& exitance,
                        const Occluder& occluder, std::span<const Sensor> sensors, const GatherOptions& options = {},
                        const Observer& observer = {});

}  // namespace patchlight
