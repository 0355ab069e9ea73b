#pragma once

#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"
#include "patchlight/simulate.h"

#include "lighting/light_source.h"
#include "render/gathered_light.h"

#include <functional>

namespace patchlight {

/// A solved scene for gathers at points: the brightest lamps apart from reflected light. Keeps a reference to the
/// simulation, which must outlive it.
SolvedLight solved_light(const Simulation& simulation);

/// The radiances of a draft picture in which these luminaires appear, W/(m^2 sr). \throws Canceled.
Image draft(const Simulation& simulation, const Camera& camera, int width, int height,
            const std::vector<Luminaire>& luminaires, const Observer& observer);

/// The radiance, W/(m^2 sr), of sky, ground and the disc of the sun in a unit direction; empty without sky and sun.
std::function<Spectrum(const Vector&)> surroundings_of(const Scene& scene);

/// That of sky and ground alone, as sensors of a solved scene see them: as far as the plan has them.
std::function<Spectrum(const Vector&)> sky_of(const Simulation& simulation);

}  // namespace patchlight
