#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include <functional>

namespace patchlight {

/// The radiance, W/(m^2 sr), of sky, ground and the disc of the sun in a unit direction; empty without a sky.
std::function<Spectrum(const Vector&)> surroundings_of(const Scene& scene);

/// That of sky and ground alone, as sensors of a solved scene see them: as far as the plan has them.
std::function<Spectrum(const Vector&)> sky_of(const Simulation& simulation);

}  // namespace patchlight
