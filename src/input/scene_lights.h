#pragma once

#include "patchlight/scene/scene.h"

#include "input/tables/read_tables.h"
#include "light/solar_position.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A luminaire of a scene file. A spectrum of one band applies to all bands.
struct LuminaireEntry {
  Luminaire luminaire;               ///< without aim and zero plane
  std::optional<Vector> aim;         ///< default: down
  std::optional<Vector> zero_plane;  ///< need not be perpendicular to the aim
  std::string where;                 ///< "room.toml:12", for messages
};

/// Position of the sun and, unless it only shapes the sky, its strength.
struct SunEntry {
  std::optional<Vector> direction;
  std::optional<SolarPosition> position;  ///< instead of a direction
  Place place;                            ///< with instant; used without direction and position
  Instant instant;
  Spectrum normal_irradiance;                            ///< may be empty, or have one band
  std::shared_ptr<const SampledSpectrum> spectrum = {};  ///< relative spectrum, or null
};

struct SkyEntry {
  SkyKind kind = SkyKind::uniform;
  Spectrum horizontal_irradiance;                        ///< may have one band
  std::optional<SolarIrradiance> measured;               ///< for perez; includes the sun
  std::shared_ptr<const SampledSpectrum> spectrum = {};  ///< relative spectrum, or null
};

/// The lights of a scene file in addition to its models' lamps.
struct LightEntries {
  std::optional<Vector> north;
  std::vector<LuminaireEntry> luminaires;
  std::optional<SunEntry> sun;
  std::optional<SkyEntry> sky;
  std::optional<WeatherHour> weather;  ///< replaces sun and sky
  double ground_reflectance = 0;
  bool photometric = false;  ///< some light is stated in lumens or lux
  std::string where;         ///< place of the sun, the sky or the weather, for messages
};

/// Adds these lights to a scene whose vertical axis and bands are known. \throws InputError.
Scene with_lights(Scene scene, const LightEntries& lights);

}  // namespace patchlight
