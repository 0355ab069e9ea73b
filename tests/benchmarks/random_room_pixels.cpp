#include "random_room_pixels.h"

#include "patchlight/views/views.h"

#include "pipeline/world.h"
#include "support/surface_places.h"
#include "verify/path_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace patchlight {
namespace {

// Pictures of each place, for their scatter.
constexpr std::uint32_t pictures = 16;

// Places with less light than this share of the room's mean do not count: too few paths find it to show a scatter.
constexpr double least_share = 1e-3;

std::string text_of(const test::SurfacePlace& place, Eigen::Index band) {
  const auto& [point, normal] = place.sensor;
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "(%.4f %.4f %.4f) (%.3f %.3f %.3f) %d", point.x(), point.y(), point.z(),
                normal.x(), normal.y(), normal.z(), static_cast<int>(band));
  return text.data();
}

// The statistics of z over a group of comparisons.
struct Statistics {
  std::size_t count = 0, within_2 = 0, within_3 = 0;
  double mean = 0, square = 0, worst = 0, share = 0;
  std::string worst_room;

  void add(double difference, double error, double light, const std::string& room) {
    // Where all methods are exact, rounding alone is left.
    const double z = difference == 0 ? 0 : difference / std::max(error, 1e-6 * light);
    ++count;
    within_2 += std::abs(z) <= 2 ? 1 : 0;
    within_3 += std::abs(z) <= 3 ? 1 : 0;
    mean += z;
    square += z * z;
    share += light > 0 ? difference / light : 0;
    if (!(std::abs(z) <= std::abs(worst))) worst = z, worst_room = room;
  }

  std::string row(const std::string& name) const {
    const auto n = static_cast<double>(std::max<std::size_t>(1, count));
    std::array<char, 256> text{};
    std::snprintf(text.data(), text.size(), "| %s | %zu | %.1f %% | %.1f %% | %+.2f | %.2f | %+.2f %% | %+.1f (%s) |\n",
                  name.c_str(), count, 100 * static_cast<double>(within_2) / n, 100 * static_cast<double>(within_3) / n,
                  mean / n, std::sqrt(square / n), 100 * share / n, worst, worst_room.c_str());
    return text.data();
  }
};

std::string rows_of(const std::string& name, const std::vector<PixelComparison>& all,
                    const std::vector<std::string>& kinds) {
  Statistics sensor_path, pixel_path, sensor_pixel;
  for (const PixelComparison& c : all) {
    if (std::find(kinds.begin(), kinds.end(), c.kind) == kinds.end()) continue;
    // The pixel shares the errors of the solution with the sensor.
    const double solution = std::sqrt(std::max(0.0, c.sensor_error * c.sensor_error - c.sensor_rays * c.sensor_rays));
    sensor_path.add(c.sensor - c.path, std::hypot(c.sensor_error, c.path_error), c.path, c.room);
    pixel_path.add(c.pixel - c.path, std::hypot(c.pixel_error, solution, c.path_error), c.path, c.room);
    sensor_pixel.add(c.sensor - c.pixel, std::hypot(c.sensor_error, c.pixel_error), c.path, c.room);
  }
  if (sensor_path.count == 0) return "";
  return sensor_path.row(name + ": sensor - path") + pixel_path.row(name + ": pixel - path") +
         sensor_pixel.row(name + ": sensor - pixel");
}

}  // namespace

std::vector<PixelComparison> compare_pixels(const test::RandomRoom& room, const Simulation& simulation,
                                            std::size_t places, std::uint32_t paths, std::uint64_t seed) {
  const std::vector<test::SurfacePlace> chosen = test::draw_surface_places(simulation, places, seed);
  std::vector<Sensor> sensors;
  for (const test::SurfacePlace& place : chosen) sensors.push_back(place.sensor);
  const Readings readings = read_sensors(simulation, {{.name = "places", .sensors = sensors}}).readings;
  const test::PlaceIrradiance pixels = test::picture_irradiance(simulation, chosen, pictures);
  const bool follows = simulation.world->tracing().reflections() == Reflections::followed;
  const PathEstimate traced = trace_irradiance(simulation.world->sensor_scene(), simulation.plan.sides, sensors,
                                               {.paths = paths, .seed = seed, .follows_reflections = follows});
  std::vector<PixelComparison> all;
  for (Eigen::Index k = 0; k < readings.irradiance.rows(); ++k)
    for (Eigen::Index band = 0; band < readings.irradiance.cols(); ++band) {
      if (!(traced.irradiance(k, band) > least_share * traced.irradiance.mean())) continue;
      all.push_back({room.name, chosen[static_cast<std::size_t>(k)].counts ? room.kind : "elsewhere",
                     text_of(chosen[static_cast<std::size_t>(k)], band), readings.irradiance(k, band),
                     readings.standard_error(k, band), readings.errors.rays(k, band), pixels.irradiance(k, band),
                     pixels.standard_error(k, band), traced.irradiance(k, band), traced.standard_error(k, band)});
    }
  return all;
}

std::string table_of(const std::vector<PixelComparison>& comparisons) {
  std::string table =
      "| comparison | values | within 2 | within 3 | mean z | rms z | mean difference | worst z |\n"
      "|---|---|---|---|---|---|---|---|\n";
  const std::vector<std::string> daylight = test::daylight_kinds(), lamps = test::lamp_kinds();
  for (const auto& kinds : {daylight, lamps})
    for (const std::string& kind : kinds) table += rows_of(kind, comparisons, {kind});
  return table + rows_of("elsewhere", comparisons, {"elsewhere"}) + rows_of("**daylight**", comparisons, daylight) +
         rows_of("**lamps**", comparisons, lamps);
}

}  // namespace patchlight
