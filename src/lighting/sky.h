#pragma once

#include "patchlight/scene/daylight.h"

#include <array>

namespace patchlight {

/// A sky prepared for evaluation. The relative radiance is (1 + a exp(b / cos zeta)) (1 + c exp(d gamma) + e cos^2
/// gamma) at the zenith angle zeta and the angle gamma from the sun, times `colour`. The CIE clear and the Perez sky
/// have this form; the uniform and the CIE overcast sky need no coefficients.
struct SkyModel {
  SkyKind kind = SkyKind::uniform;
  Vector up = Vector::UnitZ();
  Vector sun_direction = Vector::UnitZ();
  std::array<double, 5> coefficients{};  ///< a to e
  Spectrum colour;                       ///< W/(m^2 sr) for a relative radiance of 1
  Spectrum ground;                       ///< radiance below the horizon, W/(m^2 sr)
};

/// Uniform: the same radiance everywhere. CIE overcast: (1 + 2 sin altitude) / 3 of the zenith's (Moon and Spencer
/// 1942). CIE clear: ISO 15469:2004, in the form of Kittler 1967. Perez: Perez, Seals and Michalsky 1993, eqs. 2 to 7
/// and table 1. The fit takes the brightness within its limits: 0.01 to 0.6, at least 0.2 for a clearness of 1.065 to
/// 2.8, and below the values at which the horizon has no bound. The radiance is such that the sky gives its horizontal
/// irradiance, to 1e-5 of it, or else its zenith radiance. A Perez sky whose fit has no light is uniform.
SkyModel sky_model(const Sky& sky, const Vector& up);

/// The same distribution with a radiance of 1 W/(m^2 sr) for a relative radiance of 1, over a black ground; its
/// irradiance is left to the caller, who integrates by other means. Uniform where the fit has no light.
SkyModel relative_sky(const Sky& sky, const Vector& up);

/// Relative radiance of the sky in a unit direction not below the horizon; never negative.
double relative_radiance(const SkyModel& sky, const Vector& direction);

/// Radiance of sky or ground in a unit direction, W/(m^2 sr).
Spectrum radiance(const SkyModel& sky, const Vector& direction);

}  // namespace patchlight
