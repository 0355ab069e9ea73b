#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <cstdint>
#include <memory>
#include <optional>

namespace patchlight {

/// The sun: parallel light.
struct Sun {
  Vector direction = Vector::UnitZ();                 ///< unit, towards the sun
  Spectrum normal_irradiance;                         ///< on a plane perpendicular to its rays, W/m^2
  std::shared_ptr<const SampledSpectrum> spectrum{};  ///< as Luminaire::spectrum
};

/// The distribution of radiance over a sky.
enum class SkyKind : std::uint8_t { uniform, cie_overcast, cie_clear, perez };

/// The sky, without the sun, and the ground below the horizon. Spectra have the scene's number of bands. One of two
/// spectra defines the radiance of the sky.
struct Sky {
  SkyKind kind = SkyKind::uniform;
  Spectrum horizontal_irradiance{};        ///< of an unobstructed horizontal plane by the sky alone, W/m^2; or empty:
  Spectrum zenith_radiance{};              ///< then this is used, W/(m^2 sr)
  Vector sun_direction = Vector::UnitZ();  ///< unit, not below the horizon; for cie_clear and perez
  double clearness = 1;                    ///< Perez's epsilon, from 1 (overcast) up; for perez
  double brightness = 0.1;                 ///< Perez's Delta, above 0; for perez
  Spectrum ground_radiance{};              ///< below the horizon, W/(m^2 sr); empty: black
  std::shared_ptr<const SampledSpectrum> spectrum{};  ///< as Luminaire::spectrum
};

/// The measurements of weather stations, over the whole solar spectrum.
struct SolarIrradiance {
  double direct_normal = 0;       ///< W/m^2
  double diffuse_horizontal = 0;  ///< W/m^2
  int day_of_year = 1;            ///< for the sun's distance
  double precipitable_water = 2;  ///< cm
};

/// Sun and sky.
struct Daylight {
  std::optional<Sun> sun;  ///< nothing where there is no direct irradiance
  std::optional<Sky> sky;  ///< nothing where there is no diffuse irradiance
};

/// The irradiance of open horizontal ground, W/m^2 per band. Horizontal irradiance describes the sky.
Spectrum irradiance_of_ground(const Daylight& daylight, const Vector& up, Eigen::Index bands);

/// The same daylight above matt ground, whose radiance is L = rho E / pi. Unchanged without a sky.
Daylight above_ground(Daylight daylight, double reflectance, const Vector& up, Eigen::Index bands);

/// The sun and the Perez sky from measured irradiances. Clearness and brightness follow Perez, Ineichen, Seals,
/// Michalsky and Stewart 1990, eqs. 1 and 2. Their luminous efficacies (eqs. 6 to 8) convert the measurements to
/// visible light: all `bands` are equal, with 179 lm/W. The ground is black. If the sun is below the horizon, the sky
/// is uniform and has the efficacy of a sun at the horizon.
Daylight measured_daylight(const SolarIrradiance& measured, const Vector& sun_direction, const Vector& up,
                           Eigen::Index bands);

/// The class of clearness, 0 (overcast) to 7 (clear), of Perez et al. 1990, table 1.
std::size_t perez_class(double clearness);

}  // namespace patchlight
