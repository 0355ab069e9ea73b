#include "verify/delta_sources.h"

#include "base/sampling.h"
#include "verify/photometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

// E = I cos(theta) / d^2
LightSample from_point(const Luminaire& luminaire, const Vector& up, const LitPoint& at) {
  const Vector way = luminaire.position - at.point;
  const double distance = way.norm();
  const double cosine = at.normal.dot(way) / distance;
  const Spectrum intensity = radiant_intensity(luminaire, up, -way / distance);
  return {luminaire.position, std::max(0.0, cosine) / (distance * distance) * intensity};
}

// A direction uniform in the cone that the sphere fills: L cos(theta) over its density 1 / (2 pi (1 - cos(cone))).
// Shirley, Wang and Zimmerman 1996, section 3.2.
LightSample from_sphere(const SphericalLamp& lamp, const Point& centre, const LitPoint& at, const Eigen::Vector2d& uv) {
  const LightSample dark{centre, Spectrum::Zero(lamp.exitance.size())};
  const double distance = (centre - at.point).norm();
  if (distance <= lamp.radius) return dark;
  const double sine_of_cone = lamp.radius / distance;
  const double below_one = sine_of_cone * sine_of_cone / (1 + std::sqrt(1 - sine_of_cone * sine_of_cone));  // 1 - cos
  const double z = 1 - uv.x() * below_one;
  const double across = std::sqrt(std::max(0.0, 1 - z * z));
  const double turn = 2 * std::numbers::pi * uv.y();
  const Vector direction =
      frame_around((centre - at.point) / distance) * Vector(across * std::cos(turn), across * std::sin(turn), z);
  const double cosine = at.normal.dot(direction);
  if (!(cosine > 0)) return dark;
  const double middle = distance * z;
  const double chord = lamp.radius * lamp.radius - (distance * distance - middle * middle);
  const Point near = at.point + (middle - std::sqrt(std::max(0.0, chord))) * direction;
  return {near, 2 * below_one * cosine * lamp.exitance};
}

}  // namespace

DeltaSources::DeltaSources(const Scene& scene, const PathScene& faces)
    : faces_(faces), luminaires_(scene.luminaires), up_(scene.up) {
  if (scene.sun && scene.sun->direction.dot(scene.up) > 0) sun_ = scene.sun;
}

std::vector<LightSample> DeltaSources::sample(const LitPoint& at, double choice, const Eigen::Vector2d& uv) const {
  std::vector<LightSample> samples;
  std::vector<double> sizes;
  for (const Luminaire& luminaire : luminaires_) {
    const auto* sphere = std::get_if<SphericalLamp>(&luminaire.light);
    samples.push_back(sphere != nullptr ? from_sphere(*sphere, luminaire.position, at, uv)
                                        : from_point(luminaire, up_, at));
    sizes.push_back(samples.back().irradiance.mean());
  }
  double sum = 0;
  for (const double size : sizes) sum += size;
  std::vector<LightSample> chosen;
  if (sum > 0) {
    for (double& size : sizes) size /= sum;
    const std::size_t k = choose(sizes, choice).index;
    chosen.push_back({samples[k].from, samples[k].irradiance / sizes[k]});
  }
  const double cosine = sun_ ? at.normal.dot(sun_->direction) : 0;
  if (cosine > 0) chosen.push_back({faces_.beyond(at.point, sun_->direction), cosine * sun_->normal_irradiance});
  return chosen;
}

}  // namespace patchlight
