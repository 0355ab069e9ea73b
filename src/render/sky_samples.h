#pragma once

#include "patchlight/base/field.h"

#include "render/light_samples.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// An aim at its most probable openings, as each point looks at all triangles of these; others are left to rays over
/// the hemisphere.
SkyAim aim_at_few(SkyAim aim, const std::vector<Opening>& openings);

/// One estimate of the irradiance of each point (row) by sky and ground, W/m^2 per band; its mean over all samples is
/// the irradiance. There must be a sky. `rays` go from each point that has an aim: all but one to openings, where its
/// aim has any, and others over the hemisphere for what comes from elsewhere.
Field sky_samples(const Lighting& lighting, std::span<const LitPoint> points, std::uint32_t rays);

}  // namespace patchlight
