#pragma once

#include "patchlight/base/field.h"
#include "patchlight/light/spectrum.h"

#include <Eigen/Core>
#include <optional>

namespace patchlight {

/// Luminous efficacy of radiometric RGB, lm/W (the convention of Radiance). Bands of wavelengths have luminous weights
/// that give, times it, 683 lm/W at the peak of V(lambda).
inline constexpr double luminous_efficacy = 179.0;

/// Luminance in cd/m^2 of a radiance in W/(m^2 sr): 179 lm/W times the sum of the bands by their luminous weights. The
/// same turns irradiance into illuminance, and flux into luminous flux. There is a band for each value.
double luminance(const Spectrum& radiance, const Bands& bands);

/// The same of usual_bands().
double luminance(const Spectrum& radiance);

/// The weights of bands in means by luminance; they sum up to 1.
Spectrum luminous_shares(const Bands& bands);

/// X, Y and Z (CIE 1931) of a radiance, Y in cd/m^2 as luminance(); of an irradiance Y is in lx.
Eigen::Vector3d xyz_of(const Spectrum& radiance, const Bands& bands);

/// The correlated color temperature in K: that of the black body with the nearest chromaticity in the CIE 1960 diagram
/// (CIE 15:2004, 9.5). Empty if it is meaningless: a distance above 0.05, below 1,000 K, above 50,000 K, or no light.
std::optional<double> correlated_colour_temperature(const Eigen::Vector3d& xyz);

/// True when bands are of wavelengths, so that colors beyond linear RGB are known.
bool are_of_wavelengths(const Bands& bands);

/// xyz_of() each row.
Field xyz_rows(const FieldView& radiance, const Bands& bands);

/// correlated_colour_temperature() of each row of X, Y and Z; not a number where it has no meaning.
Eigen::VectorXd colour_temperatures(const FieldView& xyz);

/// A color in CIE 1976 L*, a*, b*.
using Lab = Eigen::Vector3d;

/// X, Y, Z seen beside this white (CIE 15:2004, eqs. 8.3 to 8.11).
Lab lab_of(const Eigen::Vector3d& xyz, const Eigen::Vector3d& white);

/// The color difference CIEDE2000, all parametric factors 1: Sharma, Wu and Dalal 2005, eqs. 2 to 22.
double colour_difference(const Lab& a, const Lab& b);

}  // namespace patchlight
