#pragma once

#include "patchlight/scene/luminaire.h"

namespace patchlight {

/// The radiant intensity of a luminaire without extent in a unit direction away from it, W/sr per band. `up` decides
/// the tilt of measured luminaires. Written apart from src/lighting, so that the path tracer can test it.
Spectrum radiant_intensity(const Luminaire& luminaire, const Vector& up, const Vector& direction);

}  // namespace patchlight
