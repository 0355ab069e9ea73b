#pragma once

#include "patchlight/annual/annual.h"
#include "patchlight/annual/metrics.h"

#include <filesystem>
#include <span>
#include <string>

namespace patchlight {

/// A row of the table of hours: what a weather file states, and the light that follows.
struct HourRow {
  int month = 1, day = 1, hour = 0;                          ///< standard time at which it begins
  double sun_altitude = 0, sun_azimuth = 0;                  ///< degrees, in its middle
  double direct_normal = 0, diffuse_horizontal = 0;          ///< W/m^2, as stated
  double direct_normal_lux = 0, diffuse_horizontal_lux = 0;  ///< as simulated
  bool is_occupied = false;
};

/// A year of light with its request.
struct AnnualOutput {
  const AnnualLight& light;
  const AnnualMetrics& metrics;
  std::span<const SensorGroup> groups;
  std::span<const HourRow> hours;
  std::string weather;  ///< the file's name
  int first_hour = 8, last_hour = 18;
  int sky_division = 4;
  std::string command_line;
};

/// Writes a folder, whole or not at all; one of an earlier year is replaced:
/// - illuminance.npy and sunlight.npy: 32-bit floats, hours x sensors, lx; sensors inside walls are not numbers
/// - illuminance.ill: the same as text, as Radiance's and Daysim's tools read it: month, day, middle of the hour,
/// values
/// - sensors.csv, rooms.csv: the measures with standard errors
/// - hours.csv: sun, sky and their light
/// - annual.json: request, facts and the measures of rooms
/// \throws OutputError.
void write_annual(const std::filesystem::path& folder, const AnnualOutput& output);

/// Fails early. \throws OutputError when write_annual() could not write here.
void check_annual_writable(const std::filesystem::path& folder);

}  // namespace patchlight
