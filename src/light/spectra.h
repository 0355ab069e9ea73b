#pragma once

#include "patchlight/light/spectrum.h"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>

namespace patchlight {

/// The visible light, nm, in cells of 1 nm.
inline constexpr double shortest_wavelength = 380;
inline constexpr double longest_wavelength = 780;
inline constexpr Eigen::Index number_of_cells = 400;

/// A value for the middle of each cell.
using Cells = Eigen::Array<double, number_of_cells, 1>;

/// How a table continues beyond its wavelengths.
enum class Beyond : std::uint8_t {
  zero,  ///< for lamps
  end    ///< the value at the end, for reflectances
};

/// A spectrum at the middles of the cells.
Cells in_cells(const SampledSpectrum& spectrum, Beyond beyond);

/// The color matching functions x, y and z of the CIE 1931 observer, a row for each.
const Eigen::Array<double, 3, number_of_cells>& observer_in_cells();

/// CIE standard illuminants, any multiple: D65, and A by its formula (CIE S 014-2:2006, eq. 1).
std::shared_ptr<const SampledSpectrum> illuminant_d65_spectrum();
std::shared_ptr<const SampledSpectrum> illuminant_a_spectrum();

/// The radiance of a black body of this temperature, any multiple: Planck's law.
std::shared_ptr<const SampledSpectrum> planckian_spectrum(double kelvin);

/// The temperatures for which CIE daylight is defined, K.
inline constexpr double coolest_daylight = 4000;
inline constexpr double hottest_daylight = 25000;

/// Daylight of a correlated color temperature within these, any multiple: CIE 15:2004, 3.1.
std::shared_ptr<const SampledSpectrum> daylight_spectrum(double kelvin);

/// The reflectances whose sum, times the linear RGB (Rec. 709) of a color, is a smooth spectrum that has this color
/// under D65, in [0, 1] where the color is: Mallett and Yuksel 2019. In each cell they sum up to 1.
const std::array<Cells, 3>& reflectances_of_primaries();

/// X, Y and Z of 1 W of light for which the observer has these values.
Eigen::Vector3d xyz_per_watt(const Eigen::Vector3d& observer);

/// X, Y and Z of light that is spread like this, such that 1 W has Y = 683 times y at its wavelength.
Eigen::Vector3d xyz_of_cells(const Cells& light);

/// The luminance, in cd/m^2, of a radiance in W/(m^2 sr nm), and so on.
double luminance_of_cells(const Cells& light);

/// Between XYZ and linear RGB with the primaries of Rec. 709, whose white has the luminance 1 and is that of D65 as it
/// is tabled here.
const Eigen::Matrix3d& rgb_from_xyz();
const Eigen::Matrix3d& xyz_from_rgb();

/// The linear RGB (Rec. 709) of a reflectance under D65; may be below 0 or above 1.
Spectrum rgb_of_reflectance(const SampledSpectrum& reflectance);

/// The linear RGB (Rec. 709) of a light, without negative parts, with a luminance() of 179.
Spectrum rgb_of_light(const SampledSpectrum& light);

}  // namespace patchlight
