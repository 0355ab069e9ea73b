#pragma once

#include "patchlight/scene/daylight.h"

#include "light/solar_position.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// An hour of a weather file.
struct WeatherHour {
  Place place;
  Instant middle;         ///< of the hour, UTC
  SolarIrradiance solar;  ///< means over the hour
};

/// Reads one hour of an EnergyPlus weather file (EPW): the one that begins `hour` hours (0 to 23) after midnight, local
/// standard time, of the first line with this month and day.
/// \throws InputError naming the file and line.
WeatherHour read_epw(const std::filesystem::path& file, int month, int day, int hour);

/// The same from a text; `file` is for messages.
WeatherHour parse_epw(const std::string& text, const std::string& file, const Instant& local_time);

/// Sun and Perez sky of that hour, the sun where it stands in the middle of it. scene/daylight.h.
Daylight daylight_of(const WeatherHour& weather, const Vector& up, const Vector& north, Eigen::Index bands);

}  // namespace patchlight
