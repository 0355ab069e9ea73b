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
    light_spectrum  ///< how what is emitted is spread over wavelengths; `sampled` alone
  };
  std::string material;  ///< a name, or a pattern with * for any letters and ? for one
  Quantity quantity = Quantity::reflectance;
  Spectrum value;                       ///< one value stands for all bands; an index has one
  std::string where = "read.settings";  ///< where it is asked for, for messages
  std::string of = {};                  ///< of the faces of these objects, groups or files alone, a name or a pattern;
                                        ///< empty: of all
  std::shared_ptr<const SampledSpectrum> sampled{};  ///< by wavelength; `value` is its linear RGB
};

/// Parses MATERIAL.reflectance=R,G,B (or one value for all bands), .exitance=, .radiance=, .transmittance=,
/// .diffuse_transmittance=, .specular_reflectance=, or .index= with one value.
/// \throws InputError naming read.settings.
MaterialSetting parse_material_setting(const std::string& text);

/// Daylight that is asked for besides that of the files; none by default. Measured values and those of a weather
/// file bring the strength of the sun with them.
struct DaylightSetting {
  /// Where the sun stands, degrees.
  struct SunPlace {
    double altitude = 45;  ///< above the horizon
    double azimuth = 180;  ///< from north over east
    int day_of_year = 80;  ///< for its distance, with `measured`
  };
  /// An hour of an EnergyPlus weather file (EPW), which says where the place is.
  struct WeatherFile {
    std::filesystem::path file;
    int month = 1;
    int day = 1;
    int hour = 12;  ///< at which it begins, local standard time, 0 to 23
  };
  std::optional<SkyKind> sky;
  double sky_illuminance = 10'000;                ///< of open level ground by the sky alone, lx
  std::optional<SolarIrradiance> measured;        ///< for a Perez sky; its day of the year is that of `sun`
  std::optional<SunPlace> sun;                    ///< needed by clear and Perez skies
  double sun_illuminance = 0;                     ///< across its rays, lx; 0: it only states where the sky is bright
  std::optional<WeatherFile> weather;             ///< instead of sky and sun
  std::optional<double> ground_reflectance = {};  ///< 0.2 if not given, where there is a sky
};

/// The bands that a scene is taken to.
struct BandsAsked {
  bool rgb = false;                   ///< linear RGB, whatever has a spectrum
  std::vector<double> edges_nm = {};  ///< of bands, growing; empty and not rgb: RGB where nothing has a spectrum, else
                                      ///< as many as keep colors within color_error
  double color_error = 1;             ///< CIE dE00
};

/// How a model file is to be taken.
struct ReadOptions {
  std::optional<double> metres_per_unit = {};  ///< length of one model unit, above 0, instead of the unit that the file
                                               ///< states; if not given, that one, else 1
  std::optional<Vector> up = {};               ///< if not given, what the file says, else upright_axis() of the scene
  std::vector<MaterialSetting> settings = {};
  std::filesystem::path confine = {};       ///< a folder outside of which nothing is read; if empty, any file may be
  std::vector<std::string> only = {};       ///< objects, groups or materials, nothing else takes part; empty: all
  std::vector<std::string> leave_out = {};  ///< those that do not; both names, or patterns with * and ?
  double detail = 0;        ///< meters: what is smaller is left out or taken as a box, see with_less_detail()
  bool keep_faces = false;  ///< coplanar neighbors of one object and material stay apart, see
                            ///< with_joined_faces()
  DaylightSetting daylight = {};
  std::optional<double> maintenance_factor = {};  ///< above 0, up to 1: the share of their light when new that lamps
                                                  ///< and luminaires give; if not given, what a scene file says, else 1
  std::optional<BandsAsked> bands = {};           ///< if not given, what the scene file says, else BandsAsked{}
  std::string format = {};                        ///< an extension without its dot; if empty, that of the file
};

/// The extensions of the formats that can be read, without dots.
std::vector<std::string> readable_formats();

/// Reads a model or a scene file (.toml, which names models, sensors and more); the format follows from the extension,
/// and "-" stands for the standard input, which is OBJ unless options.format says otherwise. Lengths are converted to
/// meters, emitted radiance L to exitance = pi L. Scene::notes names the parts that are not simulated.
/// docs/reference/formats/index.md has the details.
/// \throws InputError when the file is missing, unreadable or unusable.
Scene read_scene(const std::filesystem::path& file, const ReadOptions& options = {});

/// A scene that was read before, with the settings, the upright axis and the daylight of these options, which takes the
/// place of its own. \throws InputError when no material bears the name of a setting, or settings make a material that
/// check() refuses, or ask for light of other lamps in bands of wavelengths.
Scene with_options(Scene scene, const ReadOptions& options);

/// Reads several models as one scene. Materials with the same name and values become one; those that only share the
/// name are kept apart, and a note says so. \throws InputError as for one file.
Scene read_scene(std::span<const std::filesystem::path> files, const ReadOptions& options = {});

}  // namespace patchlight
