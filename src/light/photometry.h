#pragma once

#include "patchlight/light/spectrum.h"

namespace patchlight {

/// Luminous efficacy that goes with radiometric RGB, lm/W (the convention of Radiance).
inline constexpr double luminous_efficacy = 179.0;

/// Luminance in cd/m^2 of a radiance in W/(m^2 sr): 179 lm/W (0.2126 R + 0.7152 G + 0.0722 B) for three bands, the mean
/// of the bands times 179 lm/W for any other number. The same weights turn irradiance into illuminance.
double luminance(const Spectrum& radiance);

}  // namespace patchlight
