#include "render/sky_samples.h"

#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "lighting/sky.h"
#include "render/pixel_samples.h"
#include "render/spherical_triangle.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Of so few triangles each point knows how much of its hemisphere they fill; of more, its patch says which it looks at.
constexpr std::size_t few_triangles = 24;

// What is seen as smaller than this, sr, is left to rays over the hemisphere.
constexpr double least_solid_angle = 1e-8;

// Seeds of the two kinds of rays of a point.
enum SkyPurpose : std::uint32_t { to_openings = 21, over_hemisphere };

// The triangles of openings, and how often rays go to each.
struct Targets {
  std::vector<const std::array<Point, 3>*> triangles;
  std::vector<double> probabilities;
};

// A ray to the sky. What arrives is `factor` times the radiance there and the share that gets through.
struct SkyRay {
  std::size_t point = 0;
  Vector direction;
  double factor = 0;
  bool is_aimed = false;
};

Targets normalised(Targets targets) {
  double sum = 0;
  for (const double weight : targets.probabilities) sum += weight;
  if (!(sum > 0)) return {};
  for (double& probability : targets.probabilities) probability /= sum;
  return targets;
}

std::size_t triangles_of_aim(const Lighting& lighting, const SkyAim& aim) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < aim.probabilities.size(); ++k)
    if (aim.probabilities[k] > 0) count += lighting.openings[k].triangles.size();
  return count;
}

// As often as a triangle fills the hemisphere, with its cosine.
Targets targets_of_point(const Lighting& lighting, const SkyAim& aim, const SurfacePoint& at) {
  Targets targets;
  for (std::size_t k = 0; k < aim.probabilities.size(); ++k) {
    if (!(aim.probabilities[k] > 0)) continue;
    const Opening& opening = lighting.openings[k];
    const bool is_before = opening.normal.dot(at.point - opening.centre) > 0;
    for (const std::array<Point, 3>& triangle : opening.triangles) {
      std::array<Point, 3> corners = triangle;
      if (!is_before) std::swap(corners[1], corners[2]);
      const double form_factor = point_to_polygon(at.point, at.normal, corners);
      if (!(form_factor > least_solid_angle)) continue;
      targets.triangles.push_back(&triangle);
      targets.probabilities.push_back(form_factor);
    }
  }
  return normalised(std::move(targets));
}

// As often as the aim says of their opening, by their areas.
Targets targets_of_aim(const Lighting& lighting, const SkyAim& aim) {
  Targets targets;
  for (std::size_t k = 0; k < aim.probabilities.size(); ++k) {
    if (!(aim.probabilities[k] > 0)) continue;
    const Opening& opening = lighting.openings[k];
    for (std::size_t t = 0; t < opening.triangles.size(); ++t) {
      const double area = opening.upto[t] - (t == 0 ? 0 : opening.upto[t - 1]);
      targets.triangles.push_back(&opening.triangles[t]);
      targets.probabilities.push_back(aim.probabilities[k] * area / opening.area);
    }
  }
  return normalised(std::move(targets));
}

// Of rays to these, 1/sr.
double density(const Targets& targets, const Point& from, const Vector& direction) {
  double sum = 0;
  for (std::size_t k = 0; k < targets.triangles.size(); ++k) {
    const auto& [a, b, c] = *targets.triangles[k];
    // The same side of the three planes through its edges
    const double first = direction.dot((a - from).cross(b - from));
    const double second = direction.dot((b - from).cross(c - from));
    if ((first > 0) != (second > 0)) continue;
    const double third = direction.dot((c - from).cross(a - from));
    if ((first > 0) != (third > 0) || !(direction.dot(a + b + c - 3 * from) > 0)) continue;
    const double solid_angle = SphericalTriangle(from, *targets.triangles[k]).solid_angle();
    if (solid_angle > least_solid_angle) sum += targets.probabilities[k] / solid_angle;
  }
  return sum;
}

// The rays of all points, and where they aim.
class SkySampler {
 public:
  SkySampler(const Lighting& lighting, std::span<const LitPoint> points, std::uint32_t rays)
      : lighting_(lighting), points_(points), count_(rays) {
    for (std::size_t k = 0; k < points.size(); ++k)
      if (points[k].aim != nullptr) add(k);
  }

  Field irradiance() const;

 private:
  void add(std::size_t index);
  void add_ray(std::size_t index, const Vector& direction, std::uint32_t of_so_many, bool is_aimed);
  const Targets& targets(std::size_t index) const;

  const Lighting& lighting_;
  std::span<const LitPoint> points_;
  std::uint32_t count_;
  std::vector<SkyRay> rays_;
  std::vector<Segment> segments_;
  std::map<std::size_t, Targets> of_points_;
  std::map<const SkyAim*, Targets> of_aims_;
};

const Targets& SkySampler::targets(std::size_t index) const {
  static const Targets none;
  const auto of_point = of_points_.find(index);
  if (of_point != of_points_.end()) return of_point->second;
  const auto of_aim = of_aims_.find(points_[index].aim);
  return of_aim != of_aims_.end() ? of_aim->second : none;
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
  const SkyAim& aim = *point.aim;
  if (!aim.probabilities.empty()) {
    if (triangles_of_aim(lighting_, aim) <= few_triangles)
      of_points_.emplace(index, targets_of_point(lighting_, aim, point.at));
    else if (!of_aims_.contains(&aim))
      of_aims_.emplace(&aim, targets_of_aim(lighting_, aim));
  }
  const Targets& to = targets(index);
  const std::uint32_t aimed = to.triangles.empty() ? 0 : (count_ + 1) / 2;
  for (std::uint32_t k = 0; k < aimed; ++k) {
    const auto u = pixel_sample(point.sample * aimed + k, hash({point.seed, to_openings}));
    const Choice choice = choose(to.probabilities, u[0]);
    const SphericalTriangle triangle(point.at.point, *to.triangles[choice.index]);
    if (triangle.solid_angle() > least_solid_angle) add_ray(index, triangle.direction(choice.rest, u[1]), aimed, true);
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
    const double aimed = density(targets(ray.point), points_[ray.point].at.point, ray.direction);
    if (ray.is_aimed != (aimed > 0)) continue;
    const double factor = ray.is_aimed ? ray.factor / aimed : ray.factor;
    sum.row(static_cast<Eigen::Index>(ray.point)) +=
        factor * radiance(*lighting_.sky, ray.direction) * through.row(row);
  }
  return sum;
}

}  // namespace

Field sky_samples(const Lighting& lighting, std::span<const LitPoint> points, std::uint32_t rays) {
  return SkySampler(lighting, points, rays).irradiance();
}

}  // namespace patchlight
