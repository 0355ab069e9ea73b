#include "patchlight/annual/metrics.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "light/photometry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace patchlight {
namespace {

using OfSensor = std::array<double, sensor_measures>;
using OfRoom = std::array<double, room_measures>;

constexpr std::size_t at(SensorMeasure measure) { return static_cast<std::size_t>(measure); }
constexpr std::size_t at(RoomMeasure measure) { return static_cast<std::size_t>(measure); }

constexpr double target = 300;  // lx

// A year at one sensor.
struct Series {
  const AnnualLight& light;
  Eigen::Index sensor;
  double brighter;  // the factor of all but straight sunlight

  double sun(std::size_t hour) const {
    return static_cast<double>(light.sunlight(static_cast<Eigen::Index>(hour), sensor));
  }
  double all(std::size_t hour) const {
    const double straight = sun(hour);
    const double rest = static_cast<double>(light.illuminance(static_cast<Eigen::Index>(hour), sensor)) - straight;
    return straight + brighter * rest;
  }
};

// The value that is reached by `share` of the values.
double reached_by(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto count = static_cast<double>(values.size());
  const auto place = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(share * count) - 1, 0.0, count - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end(), std::greater<>());
  return values[static_cast<std::size_t>(place)];
}

OfSensor measures_of(const Series& series, const CountedHours& hours) {
  OfSensor found{};
  std::vector<double> in_daylight;
  double counted = 0;
  for (std::size_t hour = 0; hour < hours.occupied.size(); ++hour) {
    const double E = series.all(hour);
    if (hours.daylight[hour] != 0) in_daylight.push_back(E);
    if (hours.occupied[hour] == 0) continue;
    ++counted;
    found[at(SensorMeasure::mean_illuminance)] += E;
    found[at(SensorMeasure::autonomy)] += E >= target ? 1 : 0;
    found[at(SensorMeasure::continuous)] += std::min(1.0, E / target);
    const std::size_t bin = (E >= 100 ? 1 : 0) + (E >= 300 ? 1 : 0) + (E > 3000 ? 1 : 0);
    found[at(SensorMeasure::udi_below_100) + bin] += 1;
    found[at(SensorMeasure::sunlit_hours)] += series.sun(hour) > 1000 ? 1 : 0;
  }
  found[at(SensorMeasure::mean_illuminance)] /= counted;
  for (std::size_t m = at(SensorMeasure::autonomy); m <= at(SensorMeasure::udi_above_3000); ++m)
    found[m] *= 100 / counted;
  found[at(SensorMeasure::daylight_factor)] = series.brighter * series.light.daylight_factor[series.sensor];
  found[at(SensorMeasure::half_of_daylight)] = reached_by(std::move(in_daylight), 0.5);
  return found;
}

// EN 17037:2018, table A.1: the target over half and the minimum over 95 % of the plane.
double grade_of(double half, double most) {
  constexpr std::array<std::array<double, 2>, 3> levels = {{{300, 100}, {500, 300}, {750, 500}}};
  double grade = 0;
  for (const auto& [target_level, minimum_level] : levels)
    if (half >= target_level && most >= minimum_level) ++grade;
  return grade;
}

OfRoom measures_of(std::span<const OfSensor* const> sensors) {
  OfRoom found{};
  if (sensors.empty()) {
    found.fill(std::numeric_limits<double>::quiet_NaN());
    return found;
  }
  const auto count = static_cast<double>(sensors.size());
  std::vector<double> halves, factors;
  for (const OfSensor* const sensor : sensors) {
    const OfSensor& of = *sensor;
    found[at(RoomMeasure::spatial_autonomy)] += of[at(SensorMeasure::autonomy)] >= 50 ? 100 / count : 0;
    found[at(RoomMeasure::sunlight_exposure)] += of[at(SensorMeasure::sunlit_hours)] > 250 ? 100 / count : 0;
    for (std::size_t m = 0; m < 7; ++m) found[at(RoomMeasure::mean_illuminance) + m] += of[m] / count;
    halves.push_back(of[at(SensorMeasure::half_of_daylight)]);
    factors.push_back(of[at(SensorMeasure::daylight_factor)]);
  }
  found[at(RoomMeasure::median_daylight_factor)] = reached_by(std::move(factors), 0.5);
  found[at(RoomMeasure::half_of_plane)] = reached_by(halves, 0.5);
  found[at(RoomMeasure::most_of_plane)] = reached_by(halves, 0.95);
  found[at(RoomMeasure::grade)] =
      grade_of(found[at(RoomMeasure::half_of_plane)], found[at(RoomMeasure::most_of_plane)]);
  return found;
}

// The three series of a measure: as computed, brighter and darker. The error is not a number if it is not known.
template <std::size_t count>
std::array<Measure, count> with_errors(const std::array<std::array<double, count>, 3>& series, bool is_known) {
  std::array<Measure, count> found;
  for (std::size_t m = 0; m < count; ++m) {
    const double error = std::abs(series[1][m] - series[2][m]) / 2;
    found[m] = {series[0][m], is_known ? error : std::numeric_limits<double>::quiet_NaN()};
  }
  return found;
}

bool is_inside_wall(const AnnualLight& light, std::size_t sensor) {
  return light.illuminance.rows() > 0 && std::isnan(light.illuminance(0, static_cast<Eigen::Index>(sensor)));
}

bool has_known_error(const AnnualLight& light, std::size_t sensor) {
  return !std::isnan(light.relative_error[static_cast<Eigen::Index>(sensor)]);
}

using AllSensors = std::array<std::vector<OfSensor>, 3>;

RoomYear room_of(std::string name, std::size_t begin, std::size_t end, const AnnualLight& light,
                 const AllSensors& series) {
  RoomYear room{.name = std::move(name), .sensors = end - begin};
  std::array<OfRoom, 3> of_room;
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<const OfSensor*> read;
    for (std::size_t i = begin; i < end; ++i)
      if (!is_inside_wall(light, i)) read.push_back(&series[k][i]);
    room.inside_walls = room.sensors - read.size();
    of_room[k] = measures_of(read);
  }
  bool is_known = true;
  for (std::size_t i = begin; i < end; ++i)
    is_known = is_known && (is_inside_wall(light, i) || has_known_error(light, i));
  room.measures = with_errors(of_room, is_known);
  return room;
}

}  // namespace

CountedHours counted_hours(const Year& year, const Scene& scene, int first, int last) {
  if (first < 0 || last > 24 || first >= last)
    throw InputError("hours", std::to_string(first) + " to " + std::to_string(last) + ": expected two hours of a day");
  const std::size_t hours = year.hours.size();
  CountedHours counted{std::vector<std::uint8_t>(hours, 0), std::vector<std::uint8_t>(hours, 0)};
  const Bands bands = bands_of(scene);
  std::vector<std::pair<double, std::size_t>> by_light;
  for (std::size_t hour = 0; hour < hours; ++hour) {
    const auto of_day = static_cast<int>(hour % 24);
    counted.occupied[hour] = of_day >= first && of_day < last ? 1 : 0;
    const auto& sky = year.hours[hour].sky;
    by_light.emplace_back(sky ? -luminance(sky->horizontal_irradiance, bands) : 0, hour);
  }
  std::stable_sort(by_light.begin(), by_light.end());
  for (std::size_t k = 0; k < hours / 2; ++k) counted.daylight[by_light[k].second] = 1;
  return counted;
}

const char* name_of(SensorMeasure measure) {
  constexpr std::array<const char*, sensor_measures> names = {"mean_lx",
                                                              "DA300_percent",
                                                              "cDA300_percent",
                                                              "UDI_below_100_percent",
                                                              "UDI_100_300_percent",
                                                              "UDI_300_3000_percent",
                                                              "UDI_above_3000_percent",
                                                              "sun_above_1000lx_hours",
                                                              "daylight_factor_percent",
                                                              "half_daylight_hours_lx"};
  return names[at(measure)];
}

const char* name_of(RoomMeasure measure) {
  constexpr std::array<const char*, room_measures> names = {"sDA300_50_percent",
                                                            "ASE1000_250_percent",
                                                            "mean_lx",
                                                            "mean_DA300_percent",
                                                            "mean_cDA300_percent",
                                                            "mean_UDI_below_100_percent",
                                                            "mean_UDI_100_300_percent",
                                                            "mean_UDI_300_3000_percent",
                                                            "mean_UDI_above_3000_percent",
                                                            "median_daylight_factor_percent",
                                                            "EN17037_half_of_plane_lx",
                                                            "EN17037_95_percent_of_plane_lx",
                                                            "EN17037_grade"};
  return names[at(measure)];
}

AnnualMetrics metrics_of(const AnnualLight& light, std::span<const SensorGroup> groups, const CountedHours& hours) {
  const auto sensors = static_cast<std::size_t>(light.illuminance.cols());
  AllSensors series;
  for (std::vector<OfSensor>& one : series) one.resize(sensors);
  parallel_for(sensors, [&](std::size_t i) {
    const auto sensor = static_cast<Eigen::Index>(i);
    const double error = light.relative_error[sensor];
    const double spread = has_known_error(light, i) ? error : 0;
    const std::array<double, 3> factors = {1, 1 + spread, std::max(0.0, 1 - spread)};
    for (std::size_t k = 0; k < 3; ++k) {
      if (is_inside_wall(light, i))
        series[k][i].fill(std::numeric_limits<double>::quiet_NaN());
      else
        series[k][i] = measures_of(Series{light, sensor, factors[k]}, hours);
    }
  });
  AnnualMetrics found;
  for (std::size_t i = 0; i < sensors; ++i)
    found.sensors.push_back(
        with_errors<sensor_measures>({series[0][i], series[1][i], series[2][i]}, has_known_error(light, i)));
  std::size_t first = 0;
  for (const SensorGroup& group : groups) {
    found.rooms.push_back(room_of(group.name, first, first + group.sensors.size(), light, series));
    first += group.sensors.size();
  }
  found.building = room_of("all", 0, sensors, light, series);
  found.occupied_hours = static_cast<std::size_t>(std::count(hours.occupied.begin(), hours.occupied.end(), 1));
  return found;
}

}  // namespace patchlight
