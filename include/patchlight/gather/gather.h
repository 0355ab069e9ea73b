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
  int least_rays = 4;          ///< shadow rays to a patch before the sensor
  int rays = 8192;             ///< more of them to all patches together, in proportion to what patches may give
  int most_rays = 1 << 18;     ///< where these leave more than the following relative standard error
  double wanted_error = 0.01;  ///< relative standard error of a sensor
  std::uint64_t seed = 1;
};

/// Irradiance at points (rows) per band (columns), W/m^2.
struct GatheredIrradiance {
  Field irradiance;
  Field standard_error;  ///< of the shadow rays; the radiosities are taken as they are
};

/// Irradiance at points by gathering the solved radiosity: every patch by its closed-form form factor times the share
/// of it that shadow rays reach. How many rays a patch gets follows from what it could give, and not from what its rays
/// meet: where few of them get through narrow openings, none of the light is lost. The rays of a patch come in
/// replicates with random shifts of their own, whose scatter is the standard error; it is at least what the heaviest
/// ray would give of those patches whose rays agree, as no hit in n rays means at most a few in n. Sensors of which the
/// standard error is too large get more rays, in proportion to its square. The random numbers follow from the sensor's
/// place. O(points x patches). \throws Cancelled.
GatheredIrradiance gather_irradiance(const PatchMesh& mesh, const FieldView& radiosity, const Occluder& occluder,
                                     std::span<const Sensor> sensors, const GatherOptions& options = {},
                                     const Observer& observer = {});

}  // namespace patchlight
