#include "render/light_samples.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "lighting/sky.h"
#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>

namespace patchlight {
namespace {

// The part of `vector` at right angles to a unit `axis`, of length 1.
Vector across(const Vector& vector, const Vector& axis) { return (vector - vector.dot(axis) * axis).normalized(); }

// Rays to a source with extent form two halves, in turns, with independent random numbers. Each half gives the control
// coefficient of the other.
constexpr std::uint32_t halves = 2;

// Shadow rays from one point to one source.
struct SourceRays {
  std::size_t point = 0;
  std::size_t first = 0, count = 0;  // of the rays
  const Spectrum* color = nullptr;
  std::optional<double> unoccluded;  // irradiance for a color of 1
  double factor = 1;
};

struct Rays {
  std::vector<Segment> segments;
  std::vector<double> irradiance;  // of each: LightSample::irradiance
  std::vector<SourceRays> sources;
};

void add_source(Rays& to, const LightSource& source, std::size_t index, const LitPoint& point,
                const SourceChoice& choice, std::uint32_t seed) {
  SourceRays of_source{index, to.segments.size(), choice.rays, nullptr, source.unoccluded(point.at), choice.factor};
  for (std::uint32_t k = 0; k < choice.rays; ++k) {
    const std::uint32_t half = k % halves;
    const std::uint32_t rays_of_half = (choice.rays + halves - 1 - half) / halves;
    const auto u = pixel_sample_2d(point.sample * rays_of_half + k / halves, hash({seed, half}));
    const LightSample sample = source.sample(point.at, {u[0], u[1]});
    if (sample.color != nullptr) of_source.color = sample.color;
    to.irradiance.push_back(sample.irradiance);
    to.segments.push_back(segment_to(sample, point.at));
  }
  if (of_source.color != nullptr) {
    to.sources.push_back(of_source);
    return;
  }
  to.irradiance.resize(of_source.first);
  to.segments.resize(of_source.first);
}

void add_sources(Rays& to, const LightSampler& lights, std::size_t index, const LitPoint& point, std::uint32_t rays) {
  const double u = pixel_sample_2d(point.sample, hash({point.seed, stream::choice_of_source}))[0];
  const std::vector<SourceChoice> chosen = lights.choose(point.at, rays, u);
  std::uint32_t repetition = 0;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    repetition = k > 0 && chosen[k].index == chosen[k - 1].index ? repetition + 1 : 0;
    const std::uint32_t seed = hash({point.seed, stream::place_on_source, chosen[k].index, repetition});
    add_source(to, lights.sources()[chosen[k].index], index, point, chosen[k], seed);
  }
}

// The irradiance by a source for a color of 1, from the rays i = 1 ... n to it with unoccluded samples g_i and the
// transmitted shares V_i:
//
//  (1/n) sum_i (g_i V_i - c_i (g_i - F)),   c_i the mean V_j of the other half, of rays with g_j > 0; 1 if none.
//
// F is the mean of g in closed form; c_i = 0 without one. This is a control variate: as the coefficient is independent
// of the ray, the estimate stays unbiased. It has no variance where the whole source is visible, or none of it while
// each half has a ray above the horizon. Rays of one half are stratified, and so depend on each other.
double arriving_irradiance(const SourceRays& rays, const Field& through, std::span<const double> samples,
                           Eigen::Index band) {
  const auto n = static_cast<Eigen::Index>(rays.count);
  const auto shares = through.col(band).segment(static_cast<Eigen::Index>(rays.first), n);
  const auto g = samples.subspan(rays.first, rays.count);
  std::array<double, halves> seen{};
  std::array<double, halves> before{};  // rays above the horizon of both
  for (std::size_t i = 0; i < rays.count; ++i) {
    if (!(g[i] > 0)) continue;
    seen[i % halves] += shares[static_cast<Eigen::Index>(i)];
    before[i % halves] += 1;
  }
  const auto c = [&](std::size_t half) { return before[half] > 0 ? seen[half] / before[half] : 1; };
  const std::array<double, halves> of_other{c(1), c(0)};
  double sum = 0;
  for (std::size_t i = 0; i < rays.count; ++i) {
    sum += g[i] * shares[static_cast<Eigen::Index>(i)];
    if (rays.unoccluded) sum -= of_other[i % halves] * (g[i] - *rays.unoccluded);
  }
  return sum / static_cast<double>(n);
}

// A triangle of an opening as a point sees it, and how probable it is for a ray.
struct Target {
  SphericalTriangle triangle;
  double probability = 0;
};

// A ray to the sky. `factor` times the radiance there and the share that gets through arrives.
struct SkyRay {
  std::size_t point = 0;
  Vector direction;
  double factor = 0;
  bool is_aimed = false;
};

// The rays of all points that have an aim, and where they aim: all but one of `rays` to openings, where its aim has
// any, and others over the hemisphere for light from elsewhere. Estimates the irradiance of each point by sky and
// ground.
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
  double sum = 0;
  for (const Alternative& opening : points_[index].aim->openings.alternatives()) {
    for (const std::array<Point, 3>& corners : lighting_.openings[opening.index].triangles) {
      const SphericalTriangle triangle(at.point, corners);
      const double weight = triangle.solid_angle() * triangle.mean_cosine(at.normal);
      if (!(weight > 1e-8)) continue;  // sr; rays over the hemisphere find smaller ones
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

// The probability density of the rays to openings, 1/sr.
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
  // L cos over the density; that of rays to openings comes in when it is known where they end
  rays_.push_back({index, direction, (is_aimed ? cosine : std::numbers::pi) / of_so_many, is_aimed});
  segments_.push_back({at.point, lighting_.paths.beyond(at.point, direction), at.polygon, no_polygon});
}

void SkySampler::add(std::size_t index) {
  const LitPoint& point = points_[index];
  add_targets(index);
  const std::uint32_t aimed = targets_.size() == begin_[index] ? 0 : std::max(1U, count_ - 1);
  for (std::uint32_t k = 0; k < aimed; ++k) {
    auto u = pixel_sample_2d(point.sample * aimed + k, hash({point.seed, stream::sky_openings}));
    add_ray(index, chosen(index, u[0]).triangle.direction(u[0], u[1]), aimed, true);
  }
  const std::uint32_t others = std::max(1U, count_ - aimed);
  for (std::uint32_t k = 0; k < others; ++k) {
    const auto u = pixel_sample_2d(point.sample * others + k, hash({point.seed, stream::sky_hemisphere}));
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
    // Rays to openings estimate the light through these, and the others all other light: where all light comes through
    // openings, those over the hemisphere add no noise.
    const double aimed = density(ray.point, ray.direction);
    if (ray.is_aimed != (aimed > 0)) continue;
    const double factor = ray.is_aimed ? ray.factor / aimed : ray.factor;
    sum.row(static_cast<Eigen::Index>(ray.point)) +=
        factor * radiance(*lighting_.sky, ray.direction) * through.row(row);
  }
  return sum;
}

}  // namespace

SphericalTriangle::SphericalTriangle(const Point& from, const std::array<Point, 3>& corners)
    : a_((corners[0] - from).normalized()), b_((corners[1] - from).normalized()), c_((corners[2] - from).normalized()) {
  if (a_.dot(b_.cross(c_)) < 0) std::swap(b_, c_);
  ab_ = a_.cross(b_);
  bc_ = b_.cross(c_);
  ca_ = c_.cross(a_);
  // tan(omega / 2) = a . (b x c) / (1 + a.b + b.c + c.a): Van Oosterom and Strackee 1983, eq. 8
  solid_angle_ = std::max(0.0, 2 * std::atan2(a_.dot(bc_), 1 + a_.dot(b_) + b_.dot(c_) + c_.dot(a_)));
}

Vector SphericalTriangle::direction(double u, double v) const {
  // The angle at a
  const Vector to_b = across(b_, a_), to_c = across(c_, a_);
  const double cosine = std::clamp(to_b.dot(to_c), -1.0, 1.0), sine = to_b.cross(to_c).norm();
  const double alpha = std::atan2(sine, cosine);
  // The part of the triangle on b's side of the great circle through b and c' has u of its area.
  const double phi = u * solid_angle_ - alpha;
  const double s = std::sin(phi), t = std::cos(phi);
  const double p = t - cosine;
  const double q = s + sine * a_.dot(b_);
  const double below = (q * s + p * t) * sine;
  const double along = below == 0 ? 1 : std::clamp(((q * t - p * s) * cosine - q) / below, -1.0, 1.0);
  const Vector c = along * a_ + std::sqrt(1 - along * along) * to_c;
  const double z = 1 - v * (1 - c.dot(b_));
  const Vector side = c - c.dot(b_) * b_;
  if (!(side.norm() > 0)) return b_;
  return (z * b_ + std::sqrt(std::max(0.0, 1 - z * z)) * side.normalized()).normalized();
}

bool SphericalTriangle::contains(const Vector& direction) const {
  return direction.dot(ab_) >= 0 && direction.dot(bc_) >= 0 && direction.dot(ca_) >= 0;
}

double SphericalTriangle::mean_cosine(const Vector& normal) const {
  return (std::max(0.0, normal.dot(a_)) + std::max(0.0, normal.dot(b_)) + std::max(0.0, normal.dot(c_))) / 3;
}

Field light_samples(const LightSampler& lights, std::span<const LitPoint> points, std::uint32_t rays) {
  const Lighting& lighting = lights.lighting();
  Rays all;
  for (std::size_t k = 0; k < points.size(); ++k) add_sources(all, lights, k, points[k], rays);
  Field irradiance = Field::Zero(static_cast<Eigen::Index>(points.size()), lighting.bands);
  const Field through = lighting.paths.transmittance(all.segments);
  for (const SourceRays& source : all.sources) {
    const auto row = static_cast<Eigen::Index>(source.point);
    for (Eigen::Index band = 0; band < lighting.bands; ++band)
      irradiance(row, band) +=
          source.factor * (*source.color)[band] * arriving_irradiance(source, through, all.irradiance, band);
  }
  if (lighting.sky) irradiance += SkySampler(lighting, points, rays).irradiance();
  return irradiance;
}

SkyAim aim_at_few(const SkyAim& aim, const std::vector<Opening>& openings) {
  const auto all = aim.openings.alternatives();
  std::vector<Alternative> by_size(all.begin(), all.end());
  std::ranges::stable_sort(by_size, std::greater<>(), &Alternative::probability);
  std::vector<double> few(openings.size(), 0);
  std::size_t triangles = 0;
  double sum = 0;
  for (const Alternative& opening : by_size) {
    triangles += openings[opening.index].triangles.size();
    if (triangles > 32) break;
    few[opening.index] = opening.probability;
    sum += opening.probability;
  }
  if (!(sum > 0)) return {};
  for (double& probability : few) probability /= sum;
  return {Chooser(few), aim.at_panes};
}

}  // namespace patchlight
