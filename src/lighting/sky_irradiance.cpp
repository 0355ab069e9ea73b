#include "lighting/sky_irradiance.h"

#include "base/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

// The probability of each opening to be aimed at: as the solid angle that it would fill if it were turned to a place of
// the receiver, roughly; 0 behind the receiver.
std::vector<double> aim_probabilities(const Lighting& lighting, const SurfacePoint& at) {
  std::vector<double> weights;
  double sum = 0;
  for (const Opening& opening : lighting.openings) {
    double rise = 0;
    for (const auto& triangle : opening.triangles) {
      for (const Point& corner : triangle) rise = std::max(rise, at.normal.dot(corner - at.point));
    }
    const double square = (opening.centre - at.point).squaredNorm();
    weights.push_back(rise > 0 && opening.polygon != at.polygon ? opening.area / (square + opening.area) : 0);
    sum += weights.back();
  }
  for (double& weight : weights) weight = sum > 0 ? weight / sum : 0;
  return weights;
}

// A share of [0, 1) that a number falls into, and where in it.
struct Choice {
  std::size_t index = 0;
  double rest = 0;
};

// Never one without probability: when rounding leaves a rest after the last, that one.
Choice choose(const std::vector<double>& probabilities, double u) {
  Choice choice;
  double before = 0;
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    if (!(probabilities[k] > 0)) continue;
    choice = {k, std::clamp((u - before) / probabilities[k], 0.0, 1.0)};
    before += probabilities[k];
    if (u < before) break;
  }
  return choice;
}

Point point_of(const Opening& opening, double u, double v) {
  std::vector<double> shares;
  for (const auto& [a, b, c] : opening.triangles) shares.push_back((b - a).cross(c - a).norm() / 2 / opening.area);
  const Choice triangle = choose(shares, u);
  const auto& [a, b, c] = opening.triangles[triangle.index];
  const Eigen::Vector2d weights = square_to_triangle(triangle.rest, v);
  return a + weights[0] * (b - a) + weights[1] * (c - a);
}

Vector cosine_direction(const Vector& normal, double u, double v) {
  const Vector local = square_to_cosine_hemisphere(u, v);
  const Vector across = normal.unitOrthogonal();
  return local.x() * across + local.y() * normal.cross(across) + local.z() * normal;
}

// Density of the rays towards openings, 1/sr, for a direction that crosses these.
double aimed_density(const Lighting& lighting, const std::vector<double>& probabilities, const Vector& direction,
                     const std::vector<Crossing>& crossings) {
  double density = 0;
  for (const Crossing& crossing : crossings) {
    const auto opening = std::find_if(lighting.openings.begin(), lighting.openings.end(),
                                      [&](const Opening& o) { return o.polygon == crossing.polygon; });
    const auto index = static_cast<std::size_t>(opening - lighting.openings.begin());
    const double facing = std::abs(opening->normal.dot(direction));
    if (facing > 0) density += probabilities[index] * crossing.distance * crossing.distance / (facing * opening->area);
  }
  return density;
}

struct SkyRays {
  std::vector<Vector> directions;
  std::vector<double> cosines;  // to the receiver's normal
  std::vector<Segment> segments;
  std::size_t places = 0;  // from which there are one ray or two
};

SkyRays sky_rays(const Lighting& lighting, const Receiver& receiver, SamplePoints samples,
                 const std::vector<double>& probabilities) {
  const bool aims = std::any_of(probabilities.begin(), probabilities.end(), [](double p) { return p > 0; });
  SkyRays rays;
  const auto add = [&](const SurfacePoint& at, const Vector& direction) {
    const double cosine = at.normal.dot(direction);
    if (!(cosine > 0)) return;
    rays.directions.push_back(direction);
    rays.cosines.push_back(cosine);
    rays.segments.push_back({at.point, lighting.paths.beyond(at.point, direction), at.polygon, no_polygon});
  };
  for (const auto& [u, v, s, t] : samples) {
    const SurfacePoint at = receiver.place(u, v);
    if (is_covered(lighting, receiver, at)) continue;
    ++rays.places;
    add(at, cosine_direction(at.normal, s, t));
    if (!aims) continue;
    const Choice aim = choose(probabilities, s);
    add(at, (point_of(lighting.openings[aim.index], aim.rest, t) - at.point).normalized());
  }
  return rays;
}

}  // namespace

Spectrum sky_irradiance(const Lighting& lighting, const Receiver& receiver, SamplePoints samples) {
  const std::vector<double> probabilities = aim_probabilities(lighting, receiver.place(0.5, 0.5));
  const SkyRays rays = sky_rays(lighting, receiver, samples, probabilities);
  Spectrum sum = Spectrum::Zero(lighting.bands);
  if (rays.places == 0) return sum;
  // Each ray counts L cos tau over the density of rays of both kinds in its direction.
  const std::vector<Passage> passages = lighting.paths.passages(rays.segments);
  for (std::size_t k = 0; k < passages.size(); ++k) {
    if (!(passages[k].transmittance > 0).any()) continue;
    const double density = rays.cosines[k] / std::numbers::pi +
                           aimed_density(lighting, probabilities, rays.directions[k], passages[k].crossings);
    sum += radiance(*lighting.sky, rays.directions[k]) * passages[k].transmittance * (rays.cosines[k] / density);
  }
  return sum / static_cast<double>(rays.places);
}

}  // namespace patchlight
