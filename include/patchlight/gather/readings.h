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
  Field standard_error;                      ///< in all
  SensorErrors errors{};                     ///< what it is made of; empty fields: not known
  std::vector<std::uint8_t> inside_wall{};   ///< per sensor: 1 where there is nothing to read, values are NaN; or empty
  Bands bands{};                             ///< what the columns stand for
  bool photometric = false;                  ///< the lights are stated in lumens or lux: illuminance has a meaning
  std::optional<Spectrum> outside_by_sky{};  ///< irradiance of an unobstructed horizontal plane; given when a CIE
                                             ///< overcast sky is the only light: then there are daylight factors
};

/// The one value that statistics and pictures show for each sensor: illuminance in lx when the lights are photometric,
/// else irradiance in W/m^2, the bands by their luminous weights.
struct SensorValue {
  double value = 0;
  double standard_error = 0;  ///< that of bands whose errors go together, as those of the same shadow rays do
};

/// The parts of standard errors by name.
std::array<std::pair<const char*, const Field*>, 4> parts_of(const SensorErrors& errors);

/// True for a sensor inside a wall, from which nothing but the backs of surfaces is seen: it has no part in statistics.
bool is_inside_wall(const Readings& readings, std::size_t sensor);

/// The reading of one of the sensors.
SensorValue sensor_value(const Readings& readings, std::size_t sensor);

/// "lx" or "W/m^2".
const char* sensor_unit(const Readings& readings);

/// The share of the unobstructed horizontal illuminance outside that a sensor gets, in percent; readings.outside_by_sky
/// must be given.
double daylight_factor(const Readings& readings, std::size_t sensor);

/// The readings of the sensors of one group, in sensor_unit(). Those inside walls count in the first two numbers alone;
/// where all are, the others are not numbers.
struct GroupReadings {
  std::string name;
  std::size_t sensors = 0;
  std::size_t inside_walls = 0;
  double min = 0;
  double mean = 0;
  double max = 0;
  double standard_error_of_mean = 0;             ///< an upper bound: as if all errors went together
  double uniformity = 0;                         ///< U0 = min / mean; 0 in the dark
  double largest_standard_error = 0;             ///< of a sensor; not a number where one is not known
  std::optional<double> mean_daylight_factor{};  ///< percent
};

/// The statistics of each group of sensors, in their order.
std::vector<GroupReadings> by_group(std::span<const SensorGroup> groups, const Readings& readings);

}  // namespace patchlight
