#include "patchlight/gather/readings.h"

#include "light/photometry.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace patchlight {

std::array<std::pair<const char*, const Field*>, 4> parts_of(const SensorErrors& errors) {
  return {{{"rays", &errors.rays}, {"sampling", &errors.sampling}, {"mesh", &errors.mesh}, {"solver", &errors.solver}}};
}

bool is_inside_wall(const Readings& readings, std::size_t sensor) {
  return !readings.inside_wall.empty() && readings.inside_wall[sensor] != 0;
}

SensorValue sensor_value(const Readings& readings, std::size_t sensor) {
  const auto row = static_cast<Eigen::Index>(sensor);
  const double per_lux = readings.photometric ? 1 : 1 / luminous_efficacy;
  return {per_lux * luminance(readings.irradiance.row(row), readings.bands),
          per_lux * luminance(readings.standard_error.row(row), readings.bands)};
}

const char* sensor_unit(const Readings& readings) { return readings.photometric ? "lx" : "W/m^2"; }

double daylight_factor(const Readings& readings, std::size_t sensor) {
  assert(readings.outside_by_sky);
  const auto row = static_cast<Eigen::Index>(sensor);
  return 100 * luminance(readings.irradiance.row(row), readings.bands) /
         luminance(*readings.outside_by_sky, readings.bands);
}

namespace {

GroupReadings statistics(std::span<const std::size_t> sensors, const Readings& readings) {
  GroupReadings found;
  if (sensors.empty()) {
    found.min = found.mean = found.max = found.standard_error_of_mean = found.uniformity =
        found.largest_standard_error = std::numeric_limits<double>::quiet_NaN();
    return found;
  }
  const auto count = static_cast<double>(sensors.size());
  found.min = sensor_value(readings, sensors[0]).value;
  double daylight = 0;
  for (const std::size_t k : sensors) {
    const SensorValue value = sensor_value(readings, k);
    found.min = std::min(found.min, value.value);
    found.max = std::max(found.max, value.value);
    found.mean += value.value / count;
    // Minkowski's inequality: the standard error of a mean is at most the mean of the standard errors.
    found.standard_error_of_mean += value.standard_error / count;
    // An unknown error of one sensor makes the largest one unknown.
    const bool is_unknown = std::isnan(value.standard_error);
    if (is_unknown || value.standard_error > found.largest_standard_error)
      found.largest_standard_error = value.standard_error;
    if (readings.outside_by_sky) daylight += daylight_factor(readings, k) / count;
  }
  if (found.mean > 0) found.uniformity = found.min / found.mean;
  if (readings.outside_by_sky) found.mean_daylight_factor = daylight;
  return found;
}

}  // namespace

std::vector<GroupReadings> by_group(std::span<const SensorGroup> groups, const Readings& readings) {
  std::vector<GroupReadings> all;
  std::size_t first = 0;
  for (const SensorGroup& group : groups) {
    std::vector<std::size_t> read;
    for (std::size_t k = first; k < first + group.sensors.size(); ++k) {
      if (!is_inside_wall(readings, k)) read.push_back(k);
    }
    GroupReadings found = statistics(read, readings);
    found.name = group.name;
    found.sensors = group.sensors.size();
    found.inside_walls = group.sensors.size() - read.size();
    first += group.sensors.size();
    all.push_back(std::move(found));
  }
  return all;
}

}  // namespace patchlight
