#include "render/sky_samples.h"

#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "lighting/sky.h"
#include "render/pixel_samples.h"
#include "render/spherical_triangle.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Each point looks at so many triangles, to know how much of its hemisphere they fill.
constexpr std::size_t most_triangles = 32;

// What is seen as smaller than this, sr, is left to rays over the hemisphere.
constexpr double least_solid_angle = 1e-8;

// Seeds of the two kinds of rays of a point.
enum SkyPurpose : std::uint32_t { to_openings = 21, over_hemisphere };

// A triangle of an opening as a point sees it, and how probable it is for a ray.
struct Target {
  SphericalTriangle triangle;
  double probability = 0;
};

// A ray to the sky. What arrives is `factor` times the radiance there and the share that gets through.
struct SkyRay {
  std::size_t point = 0;
  Vector direction;
  double factor = 0;
  bool is_aimed = false;
};

// The rays of all points, and where they aim.
class SkySampler {
 public:
  SkySampler(const Lighting& lighting, std::span<const LitPoint> points, std::uint32_t rays)
      : lighting_(lighting), points_(points), count_(rays), begin_(points.size() + 1, 0) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (points[k].aim != nullptr) add(k);
      begin_[k + 1] = targets_.size();
    }
  }

  Field irradiance() const;

 private:
  void add(std::size_t index);
  void add_targets(std::size_t index);
  void add_ray(std::size_t index, const Vector& direction, std::uint32_t of_so_many, bool is_aimed);
  const Target& chosen(std::size_t index, double& u) const;
  double density(std::size_t index, const Vector& direction) const;

  const Lighting& lighting_;
  std::span<const LitPoint> points_;
  std::uint32_t count_;
  std::vector<Target> targets_;     // point after point
  std::vector<std::size_t> begin_;  // of each point's
  std::vector<SkyRay> rays_;
  std::vector<Segment> segments_;
};

// As often as a triangle fills the hemisphere, about, with its cosine.
void SkySampler::add_targets(std::size_t index) {
  const SurfacePoint& at = points_[index].at;
  const std::vector<double>& probabilities = points_[index].aim->probabilities;
  double sum = 0;
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    if (!(probabilities[k] > 0)) continue;
    for (const std::array<Point, 3>& corners : lighting_.openings[k].triangles) {
      const SphericalTriangle triangle(at.point, corners);
      const double weight = triangle.solid_angle() * triangle.mean_cosine(at.normal);
      if (!(weight > least_solid_angle)) continue;
      targets_.push_back({triangle, weight});
      sum += weight;
    }
  }
  for (std::size_t k = begin_[index]; k < targets_.size(); ++k) targets_[k].probability /= sum;
}

// The one that a number of [0, 1) falls into; leaves where in it.
const Target& SkySampler::chosen(std::size_t index, double& u) const {
  std::size_t k = begin_[index];
  for (; k + 1 < targets_.size() && u >= targets_[k].probability; ++k) u -= targets_[k].probability;
  u = std::min(1.0, u / targets_[k].probability);
  return targets_[k];
}

// Of the rays to openings, 1/sr.
double SkySampler::density(std::size_t index, const Vector& direction) const {
  double sum = 0;
  for (std::size_t k = begin_[index]; k < begin_[index + 1]; ++k) {
    const Target& target = targets_[k];
    if (target.triangle.contains(direction)) sum += target.probability / target.triangle.solid_angle();
  }
  return sum;
}

void SkySampler::add_ray(std::size_t index, const Vector& direction, std::uint32_t of_so_many, bool is_aimed) {
  const SurfacePoint& at = points_[index].at;
  const double cosine = at.normal.dot(direction);
  if (!(cosine > 0)) return;
  // L cos over the density, which those to openings take once what they meet is known
  rays_.push_back({index, direction, (is_aimed ? cosine : std::numbers::pi) / of_so_many, is_aimed});
  segments_.push_back({at.point, lighting_.paths.beyond(at.point, direction), at.polygon, no_polygon});
}

void SkySampler::add(std::size_t index) {
  const LitPoint& point = points_[index];
  if (!point.aim->probabilities.empty()) add_targets(index);
  const std::uint32_t aimed = targets_.size() == begin_[index] ? 0 : std::max(1U, count_ - 1);
  for (std::uint32_t k = 0; k < aimed; ++k) {
    auto u = pixel_sample(point.sample * aimed + k, hash({point.seed, to_openings}));
    add_ray(index, chosen(index, u[0]).triangle.direction(u[0], u[1]), aimed, true);
  }
  const std::uint32_t others = std::max(1U, count_ - aimed);
  for (std::uint32_t k = 0; k < others; ++k) {
    const auto u = pixel_sample(point.sample * others + k, hash({point.seed, over_hemisphere}));
    add_ray(index, cosine_direction(point.at.normal, u[0], u[1]), others, false);
  }
}

Field SkySampler::irradiance() const {
  Field sum = Field::Zero(static_cast<Eigen::Index>(points_.size()), lighting_.bands);
  const Field through = lighting_.paths.transmittance(segments_);
  for (std::size_t k = 0; k < rays_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    if (!(through.row(row) > 0).any()) continue;
    const SkyRay& ray = rays_[k];
    // What gets in through openings is the business of the rays that go there, all else that of the others: where all
    // light comes through openings, those over the hemisphere add no noise.
    const double aimed = density(ray.point, ray.direction);
    if (ray.is_aimed != (aimed > 0)) continue;
    const double factor = ray.is_aimed ? ray.factor / aimed : ray.factor;
    sum.row(static_cast<Eigen::Index>(ray.point)) +=
        factor * radiance(*lighting_.sky, ray.direction) * through.row(row);
  }
  return sum;
}

}  // namespace

SkyAim aim_at_few(SkyAim aim, const std::vector<Opening>& openings) {
  std::vector<std::size_t> order(aim.probabilities.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return aim.probabilities[a] > aim.probabilities[b]; });
  std::size_t triangles = 0;
  for (const std::size_t k : order) {
    triangles += openings[k].triangles.size();
    if (triangles > most_triangles) aim.probabilities[k] = 0;
  }
  return aim;
}

Field sky_samples(const Lighting& lighting, std::span<const LitPoint> points, std::uint32_t rays) {
  return SkySampler(lighting, points, rays).irradiance();
}

}  // namespace patchlight
