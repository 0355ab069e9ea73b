#include "views/glare.h"

#include "patchlight/views/picture.h"
#include "patchlight/views/views.h"

#include "base/tolerances.h"
#include "light/photometry.h"
#include "lighting/light_source.h"
#include "pipeline/world.h"
#include "plan/planned_scene.h"
#include "render/camera.h"
#include "views/solved_light.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <variant>

namespace patchlight {
namespace {

// The position index of a source H meters below the line of sight and Y beside it, at the distance D. It is 1 + 0.8 R /
// D, and from R = 0.6 D on 1 + 1.2 R / D. Sources farther to the side than R = 3 D count like these.
double index_below(double tangent) {
  const double ratio = std::min(tangent, 3.0);
  return 1 + (ratio < 0.6 ? 0.8 : 1.2) * ratio;
}

// Parts of an opening across and along it, whose middles the eye sees or not.
constexpr int parts = 4;

using PartsSeen = std::array<Segment, static_cast<std::size_t>(parts) * parts>;

PartsSeen ways_to_parts(const Luminaire& luminaire, const PhotometricWeb& web, const Point& eye) {
  const Vector side = luminaire.zero_plane.cross(luminaire.aim);
  PartsSeen ways;
  for (int row = 0; row < parts; ++row) {
    for (int column = 0; column < parts; ++column) {
      const double across = ((row + 0.5) / parts - 0.5) * web.opening[0];
      const double along = ((column + 0.5) / parts - 0.5) * web.opening[1];
      ways[static_cast<std::size_t>(row) * parts + static_cast<std::size_t>(column)] = {
          eye, luminaire.position + across * side + along * luminaire.zero_plane};
    }
  }
  return ways;
}

// Edge, in pixels, of the picture of the view over 180 degrees.
constexpr int view_edge = 512;

// Level directions whose mean is the cylindrical illuminance.
// E of a point's light is off by 1 - (pi / n) / sin(pi / n) at most, a third of a percent.
constexpr int directions_around = 32;

struct View {
  double background = 0;  // cd/m^2: that of the vertical illuminance without sources, over pi
  std::vector<GlareSource> sources;
};

// The measured luminaires before an eye that looks along a unit direction as sources of glare: luminance I / A_p, solid
// angle A_p / d^2, CIE 117:1995, in sixteen parts each, as far as the eye sees them. Lamps without extent are left out.
std::vector<GlareSource> luminaire_glare(const Scene& scene, const Occluder& faces, const Point& eye,
                                         const Vector& forward, const Vector& upward) {
  const Bands bands = bands_of(scene);
  std::vector<GlareSource> sources;
  for (const Luminaire& luminaire : scene.luminaires) {
    const WebLight* const light = std::get_if<WebLight>(&luminaire.light);
    const Vector way = luminaire.position - eye;
    const double distance = way.norm();
    if (!light || !(way.dot(forward) > 0)) continue;
    const Vector towards = way / distance;
    const double area = projected_opening(*light->web, {luminaire.aim, luminaire.zero_plane}, towards);
    const LightSample arrival = LightSource(luminaire, scene.up).sample({eye, towards}, Eigen::Vector2d::Zero());
    if (!(area > 0 && arrival.irradiance > 0)) continue;
    // I = E d^2 of a plane that faces the luminaire
    const Spectrum intensity = arrival.irradiance * (distance * distance) * *arrival.color;
    const double average = luminance(Spectrum(intensity / area), bands);
    const double solid_angle = area / (distance * distance) / (parts * parts);
    const PartsSeen ways = ways_to_parts(luminaire, *light->web, eye);
    const std::vector<float> seen = faces.transmittance(ways);
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const Vector direction = (ways[k].to - eye).normalized();
      if (seen[k] > 0) sources.push_back({seen[k] * average, solid_angle, position_index(direction, forward, upward)});
    }
  }
  return sources;
}

// Without measured luminaires, which are sources of their own.
Image image_of_view(const Simulation& simulation, const Camera& camera, const Observer& observer) {
  std::vector<Luminaire> luminaires = simulation.world->sensor_scene().luminaires;
  std::erase_if(luminaires, [](const Luminaire& one) { return std::holds_alternative<WebLight>(one.light); });
  return draft(simulation, camera, view_edge, view_edge, luminaires, observer);
}

View view_of(const Simulation& simulation, Camera camera, const Observer& observer) {
  const Scene& scene = simulation.world->scene();
  camera.projection = Projection::angular;
  camera.vertical_field_of_view = 180;
  const Vector up = picture_up(camera, scene.up, scene.north);
  const Lens lens(camera, up, view_edge, view_edge);
  const Image image = image_of_view(simulation, camera, observer);
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
      all.push_back(
          {ray->direction, luminance(image.pixels.row(pixel), bands), solid_angle, image.outlook[pixel] > 0.5});
      sum += all.back().luminance * solid_angle;
    }
  }
  View view;
  // cd/m^2 and times the mean: brighter things are sources of glare, as luminaires are; windows always.
  const double bright = std::max(500.0, 4 * sum / (2 * std::numbers::pi));
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

double position_index(const Vector& direction, const Vector& forward, const Vector& upward) {
  const double ahead = std::clamp(direction.dot(forward), -1.0, 1.0);
  const Vector aside = direction - ahead * forward;
  if (!(aside.norm() > tolerance_of_shapes)) return 1;
  if (direction.dot(upward) < 0)
    return index_below(ahead > 0 ? aside.norm() / ahead : std::numeric_limits<double>::infinity());
  const double radian = std::numbers::pi / 180;
  const double sigma = std::acos(ahead) / radian;
  const double tau = std::acos(std::clamp(aside.dot(upward) / aside.norm(), -1.0, 1.0)) / radian;
  return std::exp((35.2 - 0.31889 * tau - 1.22 * std::exp(-2 * tau / 9)) * 1e-3 * sigma +
                  (21 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5 * sigma * sigma);
}

std::optional<double> unified_glare_rating(std::span<const GlareSource> sources, double background) {
  double sum = 0;
  for (const GlareSource& source : sources)
    sum += std::pow(source.luminance / source.position_index, 2) * source.solid_angle;
  if (!(sum > 0 && background > 0)) return std::nullopt;
  return 8 * std::log10(0.25 / background * sum);
}

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
