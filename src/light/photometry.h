#pragma once

#include "patchlight/light/spectrum.h"

namespace patchlight {

/// Luminous efficacy that goes with radiometric RGB, lm/W (the convention of Radiance). Of bands of wavelengths the
/// luminous weights are such that times it they give 683 lm/W at the peak of V(lambda).
inline constexpr double luminous_efficacy = 179.0;

/// Luminance in cd/m^2 of a radiance in W/(m^2 sr): 179 lm/W times the sum of the bands by their luminous weights. The
/// same turns irradiance into illuminance, and flux into luminous flux. There is a band for each value.
double luminance(const Spectrum& radiance, const Bands& bands);

/// The same of usual_bands().
double luminance(const Spectrum& radiance);

/// The weights of bands in means by luminance; they sum up to 1.
Spectrum luminous_shares(const Bands& bands);

}  // namespace patchlight
