#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <cstdint>

namespace patchlight {

/// The sun: parallel light.
struct Sun {
  Vector direction = Vector::UnitZ();  ///< unit, towards the sun
  Spectrum normal_irradiance;          ///< on a plane across its rays, W/m^2
};

/// How the radiance of a sky varies over its hemisphere.
enum class SkyKind : std::uint8_t { uniform, cie_overcast, cie_clear, perez };

/// The sky, without the sun, and what is below the horizon. Spectra have the scene's number of bands. The radiance of
/// the sky is told by one of two spectra.
struct Sky {
  SkyKind kind = SkyKind::uniform;
  Spectrum horizontal_irradiance{};        ///< of an unobstructed horizontal plane by the sky alone, W/m^2; or empty:
  Spectrum zenith_radiance{};              ///< then this is used, W/(m^2 sr)
  Vector sun_direction = Vector::UnitZ();  ///< unit, above the horizon; for cie_clear and perez
  double clearness = 1;                    ///< Perez's epsilon, from 1 (overcast) up; for perez
  double brightness = 0.1;                 ///< Perez's Delta, above 0; for perez
  Spectrum ground_radiance{};              ///< below the horizon, W/(m^2 sr); empty: black
};

}  // namespace patchlight
