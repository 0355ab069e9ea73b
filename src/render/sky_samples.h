#pragma once

#include "patchlight/base/field.h"

#include "render/light_samples.h"

#include <cstdint>
#include <span>

namespace patchlight {

/// One estimate of the irradiance of each point (row) by sky and ground, W/m^2 per band; its mean over all samples is
/// the irradiance. There must be a sky. `rays` go from each point that has an aim: half of them to openings, where its
/// aim has any, and the others over the hemisphere for what comes from elsewhere.
Field sky_samples(const Lighting& lighting, std::span<const LitPoint> points, std::uint32_t rays);

}  // namespace patchlight
