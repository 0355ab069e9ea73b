#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// A change to materials, applied after reading: "light.radiance=17,12,4".
struct MaterialSetting {
  enum class Quantity {
    reflectance,
    exitance,
    radiance,
    transmittance,
    index,
    specular_reflectance,
    diffuse_transmittance,
    light_spectrum  ///< the spectrum of emitted light; uses `sampled` alone
  };
  std::string material;  ///< a name, or a pattern: * for any letters, ? for one letter
  Quantity quantity = Quantity::reflectance;
  Spectrum value;                       ///< one value applies to all bands; an index has one value
  std::string where = "read.settings";  ///< origin of the setting, for messages
  std::string of = {};                  ///< restricts the setting to faces of these objects, groups or files, a name or
                                        ///< a pattern; empty: all faces
  std::shared_ptr<const SampledSpectrum> sampled{};  ///< by wavelength; `value` is its linear RGB
};

/// Parses MATERIAL.reflectance=R,G,B (or one value for all bands), .exitance=, .radiance=, .transmittance=,
/// .diffuse_transmittance=, .specular_reflectance=, or .index= with one value.
/// \throws InputError naming read.settings.
MaterialSetting parse_material_setting(const std::string& text);

/// Daylight that replaces the sun, the sky or both of the files; none by default. Measured values and weather files
/// include the sun.
struct DaylightSetting {
  /// Position of the sun, degrees.
  struct SunPlace {
    double altitude = 45;  ///< above the horizon
    double azimuth = 180;  ///< from north over east
    int day_of_year = 80;  ///< for the distance of the sun, with `measured`
  };
  /// An hour of an EnergyPlus weather file (EPW). The file states the site.
  struct WeatherFile {
    std::filesystem::path file;
    int month = 1;
    int day = 1;
    int hour = 12;  ///< start of the hour, local standard time, 0 to 23
  };
  std::optional<SkyKind> sky;
  double sky_illuminance = 10'000;                ///< horizontal illuminance of open ground by the sky alone, lx
  std::optional<SolarIrradiance> measured;        ///< for a Perez sky; its day of the year equals that of `sun`
  std::optional<SunPlace> sun;                    ///< required by clear and Perez skies
  double sun_illuminance = 0;                     ///< direct normal illuminance, lx; 0: the sun only shapes the sky
  std::optional<WeatherFile> weather;             ///< instead of sky and sun
  std::optional<double> ground_reflectance = {};  ///< default: 0.2 where there is a sky
};

/// The requested bands of a scene.
struct BandsAsked {
  bool rgb = false;                   ///< linear RGB, even for materials and lights with spectra
  std::vector<double> edges_nm = {};  ///< increasing band edges; if empty and not rgb: RGB without spectra, else as
                                      ///< many bands as keep colors within color_error
  double color_error = 1;             ///< CIE dE00
};

/// Options for reading a model file.
struct ReadOptions {
  std::optional<double> metres_per_unit = {};  ///< length of one model unit, above 0; replaces the unit of the file;
                                               ///< default: that unit, else 1
  std::optional<Vector> up = {};               ///< default: the axis that the file states, else upright_axis() of the
                                               ///< scene
  std::vector<MaterialSetting> settings = {};
  std::filesystem::path confine = {};       ///< patchlight reads no file outside this folder; empty: no restriction
  std::vector<std::string> only = {};       ///< objects, groups or materials to keep; empty: all
  std::vector<std::string> leave_out = {};  ///< objects, groups or materials to remove; both lists hold names or
                                            ///< patterns with * and ?
  double detail = 0;        ///< meters; smaller parts are removed or replaced by boxes, see with_less_detail()
  bool keep_faces = false;  ///< keep coplanar neighbors of one object and material apart, see with_joined_faces()
  DaylightSetting daylight = {};
  bool needs_up = false;  ///< the caller adds daylight later, which depends on the vertical axis and north
  std::optional<double> maintenance_factor = {};  ///< fraction of the initial light of lamps and luminaires, above 0,
                                                  ///< up to 1; default: that of the scene file, else 1
  std::optional<BandsAsked> bands = {};           ///< default: those of the scene file, else BandsAsked{}
  std::string format = {};                        ///< an extension without its dot; empty: that of the file
};

/// The extensions of all readable formats, without dots.
std::vector<std::string> readable_formats();

/// Reads a model or a scene file (.toml with models, sensors and more). The extension gives the format; "-" is the
/// standard input, OBJ unless options.format differs. Lengths are converted to meters, radiance L to exitance pi L.
/// Scene::notes names the parts that are not simulated. Details: docs/reference/formats/index.md.
/// \throws InputError when the file is missing, unreadable or unusable.
Scene read_scene(const std::filesystem::path& file, const ReadOptions& options = {});

/// Applies the settings, the vertical axis and the daylight of the options to a scene that was read before. In bands of
/// wavelengths the spectrum of new light is approximate, with a note.
/// \throws InputError when no material has the name of a setting, or check() refuses a changed material.
Scene with_options(Scene scene, const ReadOptions& options);

/// Reads several models as one scene. Materials with the same name and values are merged. Materials with the same name
/// and different values stay apart, with a note. \throws InputError as for one file.
Scene read_scene(std::span<const std::filesystem::path> files, const ReadOptions& options = {});

}  // namespace patchlight
