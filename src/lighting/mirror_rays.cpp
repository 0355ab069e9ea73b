#include "lighting/mirror_rays.h"

#include "base/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

namespace patchlight {
namespace {

// A straight line crosses no more clear faces than this.
constexpr int most_faces_crossed = 64;

constexpr double least_weight = 1e-3;

// The largest mirrors, towards which rays are sent; smaller ones are found by rays over the hemisphere.
constexpr std::size_t most_targets = 256;

}  // namespace

MirrorView::MirrorView(const Scene& scene, const PaneSides& sides, const Tracing& tracing)
    : sides_(sides), occluder_(tracing.all_faces()) {
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    if (sides.is_specular(p)) targets_.push_back(opening_at(scene, p));
  std::stable_sort(targets_.begin(), targets_.end(),
                   [](const Opening& a, const Opening& b) { return a.area > b.area; });
  if (targets_.size() > most_targets) targets_.resize(most_targets);
}

namespace {

// Does some corner of the target lie before the receiver?
bool rises_above(const Opening& target, const SurfacePoint& at) {
  const double middle = at.normal.dot(target.centre - at.point);
  if (std::abs(middle) > (1 + 1e-9) * target.radius) return middle > 0;
  for (const auto& triangle : target.triangles)
    for (const Point& corner : triangle)
      if (at.normal.dot(corner - at.point) > 0) return true;
  return false;
}

}  // namespace

// Roughly as the solid angle of each if it were turned to the receiver.
MirrorView::Aim MirrorView::aim_from(const SurfacePoint& at) const {
  Aim aim;
  double sum = 0;
  for (const Opening& target : targets_) {
    const double weight = rises_above(target, at) && target.polygon != at.polygon
                              ? target.area / ((target.centre - at.point).squaredNorm() + target.area)
                              : 0;
    aim.probabilities.push_back(weight);
    sum += weight;
  }
  if (!(sum > 0)) return {};
  for (double& probability : aim.probabilities) probability /= sum;
  return aim;
}

// 1/sr
double MirrorView::Aim::density(const MirrorView& view, const SurfacePoint& at, const Vector& direction) const {
  double density = 0;
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    if (!(probabilities[k] > 0)) continue;
    const Opening& target = view.targets_[k];
    const std::optional<double> distance = distance_to(target, at.point, direction);
    const double facing = std::abs(target.normal.dot(direction));
    if (distance && facing > 0) density += probabilities[k] * *distance * *distance / (facing * target.area);
  }
  return density;
}

// Straight on, through clear faces.
void MirrorView::follow(Ray ray, Spectrum weight, std::vector<MirrorRay>& into) const {
  for (int crossing = 0; crossing < most_faces_crossed; ++crossing) {
    const std::optional<Hit> hit = occluder_.first_hits({&ray, 1}).front();
    if (!hit || !sides_.is_specular(hit->polygon)) return;
    const Spectrum reflected = sides_.specular_reflectance(hit->polygon, hit->direction);
    if ((reflected > 0).any())
      into.push_back(
          {{hit->point, occluder_.mirrored(hit->polygon, hit->direction), hit->polygon}, weight * reflected});
    if (!sides_.is_clear(hit->polygon)) return;
    weight *= sides_.transmittance(hit->polygon, hit->direction);
    ray = {hit->point, hit->direction, hit->polygon};
  }
}

std::vector<MirrorRay> MirrorView::further(std::span<const MirrorRay> rays, double whole) const {
  std::vector<MirrorRay> met;
  for (const auto& [ray, weight] : rays) follow(ray, weight, met);
  std::erase_if(met, [&](const MirrorRay& one) { return one.weight.maxCoeff() < least_weight * whole; });
  return met;
}

void MirrorView::add_rays(const SurfacePoint& at, std::span<const std::array<double, 4>> samples,
                          std::vector<MirrorRay>& into) const {
  const Aim aim = aim_from(at);
  if (aim.probabilities.empty()) return;
  const std::size_t half = samples.size() / 2;
  for (std::size_t k = 0; k < 2 * half; ++k) {
    const auto& [u, v, s, t] = samples[k];
    Vector direction;
    if (k < half) {
      direction = cosine_direction(at.normal, s, t);
    } else {
      const Choice chosen = choose(aim.probabilities, s);
      direction = (point_of(targets_[chosen.index], chosen.rest, t) - at.point).normalized();
    }
    const double cosine = at.normal.dot(direction);
    if (!(cosine > 0)) continue;
    const double density = cosine / std::numbers::pi + aim.density(*this, at, direction);
    const double weight = cosine / (static_cast<double>(half) * density);
    follow({at.point, direction, at.polygon}, Spectrum::Constant(sides_.bands(), weight), into);
  }
}

}  // namespace patchlight
