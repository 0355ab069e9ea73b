#pragma once

#include "patchlight/scene/scene.h"

#include "light/pane.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// The panes that a clear material is, one per band; none of an opaque one.
std::vector<Pane> panes_of(const Material& material);

/// What they let through at an angle of incidence with this cosine, per band.
Spectrum transmittance(const std::vector<Pane>& panes, double cosine);

/// What they reflect as mirrors do.
Spectrum specular_reflectance(const std::vector<Pane>& panes, double cosine);

/// Of the angle between a unit normal and a unit direction, whichever way both look.
double cosine_between(const Vector& normal, const Vector& direction);

/// The share of light that is kept, to be reflected or absorbed: 1 less the transmittance, and 1e-6 at least.
double held_of(double transmittance);

/// Light from all directions alike, by the cosine of its angle to a normal: so many parts of the range of the cosine,
/// the midpoints of which stand for them, leave what ordinary glass holds right within 2e-6.
inline constexpr std::size_t cosine_steps = 1024;

/// The middle of a part.
double cosine_of_step(std::size_t step);

/// The share of the irradiance that comes within a part; 1 in all.
double irradiance_of_step(std::size_t step);

/// The share of light from all directions alike, weighted as irradiance is, that panes keep, per band; without what
/// they reflect where that goes on.
Spectrum hemispherical_held(const std::vector<Pane>& panes, bool reflections_go_on = false);

}  // namespace patchlight
