#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "light/photometry.h"
#include "pipeline/world.h"
#include "plan/planned_scene.h"
#include "render/glare.h"
#include "render/lens.h"
#include "views/luminaire_glare.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

// Of the picture of what is in view, over 180 degrees.
constexpr int view_edge = 512;

// Level directions whose mean is the cylindrical illuminance.
// E of a point's light is off by 1 - (pi / n) / sin(pi / n) at most, a third of a percent.
constexpr int directions_around = 32;

// What is seen brighter than this and so many times the mean is a source of glare, as luminaires are; windows always.
constexpr double least_glare = 500;  // cd/m^2
constexpr double times_the_mean = 4;

struct View {
  double background = 0;  // cd/m^2: that of the vertical illuminance without sources, over pi
  std::vector<GlareSource> sources;
};

View view_of(const Simulation& simulation, Camera camera, const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  camera.projection = Projection::angular;
  camera.vertical_field_of_view = 180;
  const Picture picture =
      take_picture(simulation, {.camera = camera, .width = view_edge, .height = view_edge}, observer);
  const Vector up = picture_up(camera, scene.up, scene.north);
  const Lens lens(camera, up, view_edge, view_edge);
  const Vector forward = (camera.target - camera.eye).normalized();
  const Vector upward = (up - up.dot(forward) * forward).normalized();
  const Bands bands = bands_of(scene);
  const double step = std::numbers::pi / view_edge;  // radians a pixel

  struct Seen {
    Vector direction;
    double luminance, solid_angle;
    bool outlook;
  };
  std::vector<Seen> all;
  double sum = 0;
  for (int y = 0; y < view_edge; ++y) {
    for (int x = 0; x < view_edge; ++x) {
      const auto ray = lens.ray(x + 0.5, y + 0.5);
      if (!ray) continue;
      const Eigen::Index pixel = static_cast<Eigen::Index>(y) * view_edge + x;
      const double angle = std::acos(std::clamp(ray->direction.dot(forward), -1.0, 1.0));
      // Angles are in proportion to the distance from the middle: d omega = sin(angle) / angle dx dy.
      const double solid_angle = step * step * (angle > 0 ? std::sin(angle) / angle : 1);
      all.push_back({ray->direction, luminance(picture.radiance.pixels.row(pixel), bands), solid_angle,
                     picture.radiance.outlook[pixel] > 0.5});
      sum += all.back().luminance * solid_angle;
    }
  }
  View view;
  const double bright = std::max(least_glare, times_the_mean * sum / (2 * std::numbers::pi));
  for (const Seen& seen : all) {
    if (seen.outlook || seen.luminance > bright)
      view.sources.push_back({seen.luminance, seen.solid_angle, position_index(seen.direction, forward, upward)});
    else
      view.background += seen.luminance * seen.direction.dot(forward) * seen.solid_angle / std::numbers::pi;
  }
  for (const GlareSource& source :
       luminaire_glare(simulation.world->sensor_scene(), simulation.world->all_faces(), camera.eye, forward, upward))
    view.sources.push_back(source);
  return view;
}

// At the eye: towards the target, and around the upright axis.
std::vector<Sensor> sensors_of(const Camera& camera, const Scene& scene) {
  std::vector<Sensor> sensors = {{camera.eye, (camera.target - camera.eye).normalized()}};
  const Vector east = scene.north.cross(scene.up);
  for (int k = 0; k < directions_around; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / directions_around;
    sensors.push_back({camera.eye, (std::cos(angle) * east + std::sin(angle) * scene.north).normalized()});
  }
  return sensors;
}

}  // namespace

std::vector<ObserverReading> read_observers(const Simulation& simulation, const std::vector<Camera>& cameras,
                                            const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  std::vector<ObserverReading> all;
  for (const Camera& camera : cameras) {
    const Readings readings = read_sensors(simulation, {{camera.name, sensors_of(camera, scene)}}, observer).readings;
    const auto illuminance = [&](std::size_t sensor) {
      return std::numbers::pi *
             luminance(Spectrum(readings.irradiance.row(static_cast<Eigen::Index>(sensor)) / std::numbers::pi),
                       readings.bands);
    };
    ObserverReading reading{.name = camera.name, .vertical_illuminance = illuminance(0)};
    for (std::size_t k = 1; k <= directions_around; ++k)
      reading.cylindrical_illuminance += illuminance(k) / directions_around;
    const View view = view_of(simulation, camera, observer);
    reading.background_luminance = view.background;
    for (const GlareSource& source : view.sources) reading.glare_solid_angle += source.solid_angle;
    reading.unified_glare_rating = unified_glare_rating(view.sources, view.background);
    all.push_back(std::move(reading));
  }
  return all;
}

}  // namespace patchlight
