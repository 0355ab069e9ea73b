#include "verify/exposed.h"

#include "base/sampling.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {
namespace {

constexpr std::uint32_t rays_per_point = 8;

// Slope of the rays around the horizon.
constexpr double grazing_slope = 1e-3;

// A face lies against the receiver when it is so near to it, as a share of the scene's extent.
constexpr double contact = 1e-5;

struct VisibilityTest {
  const Occluder& occluder;
  const Surfaces& surfaces;
  const PathReceiver& receiver;
  Vector normal;
  Eigen::Matrix3d frame;
  double reach;  // metres within which a face lies against the receiver

  bool looks_out(const Ray& ray) const;
  std::vector<Ray> rays_from(const Point& point, std::uint32_t seed) const;
};

// True when the ray meets a kept side, or gets into the open.
bool VisibilityTest::looks_out(const Ray& ray) const {
  const auto hit = occluder.first_hits({&ray, 1}).front();
  if (hit) return surfaces.at(hit->polygon, hit->side).kept;
  // What lies in the receiver's plane is met only from a little behind.
  Ray from_behind = ray;
  from_behind.origin -= reach * normal;
  const auto second = occluder.first_hits({&from_behind, 1}).front();
  if (!second || second->distance * ray.direction.dot(normal) >= 2 * reach) return true;
  // What the receiver lies over is met from behind.
  const Side other = second->side == Side::front ? Side::back : Side::front;
  return occluder.lies_over(receiver.polygon, second->polygon, other);
}

std::vector<Ray> VisibilityTest::rays_from(const Point& point, std::uint32_t seed) const {
  std::vector<Ray> rays;
  for (const auto& u : scrambled_sobol(rays_per_point, seed)) {
    rays.push_back({point, frame * square_to_cosine_hemisphere(u[0], u[1]), receiver.polygon});
  }
  for (std::uint32_t k = 0; k < rays_per_point; ++k) {
    const double azimuth = 2 * std::numbers::pi * k / rays_per_point;
    const Vector direction = Vector(std::cos(azimuth), std::sin(azimuth), grazing_slope).normalized();
    rays.push_back({point, frame * direction, receiver.polygon});
  }
  return rays;
}

}  // namespace

std::vector<std::uint8_t> exposed(const Occluder& occluder, const Surfaces& surfaces, const PathReceiver& receiver,
                                  std::span<const Point> points, std::uint64_t seed) {
  const Vector normal = surfaces.at(receiver.polygon, receiver.side).normal;
  const VisibilityTest visibility{
      occluder, surfaces, receiver, normal, frame_around(normal), contact / occluder.frame().scale};
  std::vector<std::uint8_t> result;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const bool under_another = occluder.is_covered(receiver.polygon, receiver.side, points[k]);
    const std::vector<Ray> rays = visibility.rays_from(points[k], hash({seed, k}));
    const auto looks_out = [&](const Ray& ray) { return visibility.looks_out(ray); };
    result.push_back(!under_another && std::any_of(rays.begin(), rays.end(), looks_out) ? 1 : 0);
  }
  return result;
}

}  // namespace patchlight
