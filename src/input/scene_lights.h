#pragma once

#include "patchlight/scene/scene.h"

#include "input/tables/read_tables.h"
#include "light/solar_position.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// A luminaire that a scene file names; its spectra may have one band, which stands for all.
struct LuminaireEntry {
  Luminaire luminaire;               ///< but for its aim and zero plane
  std::optional<Vector> aim;         ///< else straight down
  std::optional<Vector> zero_plane;  ///< need not be at right angles to the aim
  std::string where;                 ///< "room.toml:12", for messages
};

/// Where the sun stands and, unless it only shapes the sky, how strong it is.
struct SunEntry {
  std::optional<Vector> direction;
  std::optional<SolarPosition> position;  ///< instead of a direction
  Place place;                            ///< with instant, where there is neither
  Instant instant;
  Spectrum normal_irradiance;                            ///< may be empty, or of one band
  std::shared_ptr<const SampledSpectrum> spectrum = {};  ///< how it is spread, or null
};

struct SkyEntry {
  SkyKind kind = SkyKind::uniform;
  Spectrum horizontal_irradiance;                        ///< may be of one band
  std::optional<SolarIrradiance> measured;               ///< for perez; brings the sun with it
  std::shared_ptr<const SampledSpectrum> spectrum = {};  ///< how it is spread, or null
};

/// The lights that a scene file names besides its models' lamps.
struct LightEntries {
  std::optional<Vector> north;
  std::vector<LuminaireEntry> luminaires;
  std::optional<SunEntry> sun;
  std::optional<SkyEntry> sky;
  std::optional<WeatherHour> weather;  ///< instead of sun and sky
  double ground_reflectance = 0;
  bool photometric = false;  ///< some light is stated in lumens or lux
  std::string where;         ///< of the sun, the sky or the weather, for messages
};

/// The scene with these lights, once its upright axis and its bands are known. \throws InputError.
Scene with_lights(Scene scene, const LightEntries& lights);

}  // namespace patchlight
