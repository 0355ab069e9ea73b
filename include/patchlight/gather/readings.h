#pragma once

#include "patchlight/base/field.h"
#include "patchlight/gather/gather.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/scene/sensor.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// The readings of the sensors of a scene: a row for each, group after group, a column for each band, W/m^2.
struct Readings {
  Field irradiance;
  Field standard_error;                      ///< total
  SensorErrors errors{};                     ///< its parts; empty fields: unknown
  std::vector<std::uint8_t> inside_wall{};   ///< per sensor: 1 if it is inside a wall, with NaN values; or empty
  Bands bands{};                             ///< the meaning of the columns
  bool photometric = false;                  ///< the lights are stated in lumens or lux: illuminance has a meaning
  std::optional<Spectrum> outside_by_sky{};  ///< irradiance of an unobstructed horizontal plane; given when a CIE
                                             ///< overcast sky is the only light: then there are daylight factors
};

/// The one value that statistics and pictures show for each sensor: illuminance in lx when the lights are photometric,
/// else irradiance in W/m^2, the bands by their luminous weights.
struct SensorValue {
  double value = 0;
  double standard_error = 0;  ///< with fully correlated errors of bands, as bands share shadow rays
};

/// The parts of standard errors by name.
std::array<std::pair<const char*, const Field*>, 4> parts_of(const SensorErrors& errors);

/// True for a sensor inside a wall, which sees only the backs of surfaces. Statistics exclude it.
bool is_inside_wall(const Readings& readings, std::size_t sensor);

/// The reading of one of the sensors.
SensorValue sensor_value(const Readings& readings, std::size_t sensor);

/// "lx" or "W/m^2".
const char* sensor_unit(const Readings& readings);

/// The share of the unobstructed horizontal illuminance outside that a sensor gets, in percent; readings.outside_by_sky
/// must be given.
double daylight_factor(const Readings& readings, std::size_t sensor);

/// The statistics of one group of sensors, in sensor_unit(). Sensors inside walls count only in the first two numbers;
/// if all are inside walls, the others are NaN.
struct GroupReadings {
  std::string name;
  std::size_t sensors = 0;
  std::size_t inside_walls = 0;
  double min = 0;
  double mean = 0;
  double max = 0;
  double standard_error_of_mean = 0;             ///< an upper bound, for fully correlated errors
  double uniformity = 0;                         ///< U0 = min / mean; 0 in the dark
  double largest_standard_error = 0;             ///< of a sensor; NaN if one is unknown
  std::optional<double> mean_daylight_factor{};  ///< percent
};

/// The statistics of each group of sensors, in their order.
std::vector<GroupReadings> by_group(std::span<const SensorGroup> groups, const Readings& readings);

}  // namespace patchlight
