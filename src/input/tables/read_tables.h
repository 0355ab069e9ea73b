#pragma once

#include "patchlight/base/diagnostics.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/scene/daylight.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"
#include "patchlight/scene/year.h"

#include "light/solar_position.h"
#include "scene/photometric_web.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// Reads lines `x y z nx ny nz` separated by spaces, tabs or commas, like input for Radiance's rtrace: a position in
/// units of `metres_per_unit` and a direction of any length. Skips empty lines and text after #. The group has the name
/// of the file, which may be a pipe. \throws InputError naming the file and line.
SensorGroup read_points(const std::filesystem::path& file, double metres_per_unit);

/// The same from a text; `file` gives the group its name.
SensorGroup parse_points(std::string_view text, const std::filesystem::path& file, double metres_per_unit);

/// Reads a spectrum: lines with a wavelength in nm and a value, separated by a comma, a semicolon or spaces, with #
/// comments and one line of headings. Also reads the first set of values of CGATS files (Argyll's spotread), divided by
/// SPECTRAL_NORM. \throws InputError naming file and line for decreasing wavelengths, values that are negative or not
/// finite, or a missing spectrum.
SampledSpectrum read_spectrum(const std::filesystem::path& file);

/// The same of a text.
SampledSpectrum parse_spectrum(std::string_view text, const std::filesystem::path& file);

/// An hour of a weather file.
struct WeatherHour {
  Place place;
  Instant middle;         ///< middle of the hour, UTC
  SolarIrradiance solar;  ///< means over the hour
  std::string where{};    ///< file and line
  int begin = 0;          ///< local standard time, 0 to 23
};

/// Reads one hour of an EnergyPlus weather file (EPW): the hour that begins `hour` (0 to 23) in local standard time, in
/// the first line with this month and day.
/// \throws InputError naming the file and line.
WeatherHour read_epw(const std::filesystem::path& file, int month, int day, int hour);

/// The same from a text; `file` is for messages.
WeatherHour parse_epw(const std::string& text, const std::string& file, const Instant& local_time);

/// All hours of a weather file, from the first of January; 8760, as a leap day is left out.
struct WeatherYear {
  Place place;
  double time_zone = 0;  ///< hours, east positive
  std::string file;
  std::vector<WeatherHour> hours;
  Diagnostics notes;  ///< a leap day; direct sunlight while the sun is below the horizon
};

/// Reads a whole year. Refuses missing, repeated and misplaced hours, several periods or records per hour, numbers out
/// of range, and a time zone that is far from the longitude. \throws InputError naming the file and line.
WeatherYear read_epw_year(const std::filesystem::path& file);

/// The same from a text; `file` is for messages.
WeatherYear parse_epw_year(const std::string& text, const std::string& file);

/// Sun, sky and ground of every hour for a scene, each as with the hour of read_epw().
Year daylight_of(const WeatherYear& weather, const Scene& scene, double ground_reflectance);

/// Sun and Perez sky of that hour, with the sun at its position in the middle of the hour; see scene/daylight.h.
Daylight daylight_of(const WeatherHour& weather, const Vector& up, const Vector& north, Eigen::Index bands);

/// Reads a photometric file, IES LM-63 of 1986, 1991, 1995 or 2002: types A, B and C, TILT=NONE or INCLUDE, relative
/// and absolute photometry, dimensions in feet or meters. Candela values are multiplied by the candela multiplier, the
/// ballast factor and the ballast-lamp factor of the file. \throws InputError naming the file and line.
PhotometricWeb read_ies(const std::filesystem::path& file);

/// The same from a text; `file` is for messages.
PhotometricWeb parse_ies(const std::string& text, const std::string& file);

}  // namespace patchlight
