#pragma once

#include "patchlight/base/field.h"

#include "lighting/lamp_faces.h"
#include "lighting/lighting.h"
#include "lighting/sky_irradiance.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// What gives light straight to points.
struct Lights {
  std::vector<LampFace> lamps;  ///< emitting faces
  const Lighting& lighting;     ///< luminaires, sun and sky
};

/// A point that gets light, and what its random numbers follow from.
struct LitPoint {
  SurfacePoint at;
  std::uint32_t sample = 0;     ///< place in a sequence: those of one sequence are spread evenly together
  std::uint32_t seed = 0;       ///< of the sequence
  const SkyAim* aim = nullptr;  ///< rays to the sky; null where there is none
};

/// One estimate of the irradiance of each point (row) by lights that shine on it straight or through clear faces,
/// W/m^2 per band; its mean over all samples is the irradiance. `rays` go to lamps, 2 or more, and as many to
/// luminaires, which choose among these, or to each one if there are few; one to the sun, and `rays` to the sky.
Field light_samples(const Lights& lights, std::span<const LitPoint> points, std::uint32_t rays);

}  // namespace patchlight
