#include "render/light_samples.h"

#include "base/sampling.h"
#include "base/streams.h"
#include "form_factor/point_polygon.h"
#include "lighting/sky.h"
#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

// The part of `vector` at right angles to a unit `axis`, of length 1.
Vector across(const Vector& vector, const Vector& axis) { return (vector - vector.dot(axis) * axis).normalized(); }

// So many lamps or luminaires get rays each; of more, some are chosen for each point.
constexpr std::size_t few_lights = 4;

// Rays to a chosen lamp; each half gives the control coefficient of the other.
constexpr std::uint32_t rays_of_lamp = 2;

// Rays to a lamp form two halves, in turns, with independent random numbers.
constexpr std::uint32_t halves = 2;

// A ray to a place on a light. `light` times the share that gets through arrives.
struct LightRay {
  std::size_t point = 0;
  Segment segment;
  Spectrum light;  // W/m^2
};

// Rays to one lamp, whose irradiance without shadows is known.
struct LampRays {
  std::size_t point = 0;
  std::size_t first = 0, count = 0;  // of the rays
  double form_factor = 0;
  const LampFace* lamp = nullptr;
  double factor = 1;  // as often as it counts
};

// How a lamp is asked.
struct LampChoice {
  std::uint32_t rays = 0;
  double factor = 1;
  std::uint32_t seed = 0;
};

struct Rays {
  std::vector<LightRay> single;
  std::vector<Segment> to_lamps;
  std::vector<double> kernels;  // of each of these: the form factor that it stands for
  std::vector<LampRays> lamps;
};

// The form factor of a lamp that one place on it stands for: cos cos' A / (pi r^2).
double kernel(const LampFace& lamp, const SurfacePoint& at, const Point& place) {
  const Vector toward = place - at.point;
  const double cosine = at.normal.dot(toward);
  const double cosine_there = -lamp.normal.dot(toward);
  if (!(cosine > 0 && cosine_there > 0)) return 0;
  const double square = toward.squaredNorm();
  return cosine * cosine_there * lamp.area / (std::numbers::pi * square * square);
}

std::size_t corner_count(const LampFace& lamp) { return lamp.corners[2] == lamp.corners[3] ? 3 : 4; }

// About the light that a lamp may give, mean of the bands: above 0 wherever each of lamp and point is before the other.
double possible_light(const LampFace& lamp, const SurfacePoint& at) {
  double rise = 0;
  for (const Point& corner : lamp.corners) rise = std::max(rise, at.normal.dot(corner - at.point));
  const double before = lamp.normal.dot(at.point - lamp.corners[0]);
  if (!(rise > 0 && before > 0)) return 0;
  const Point middle = (lamp.corners[0] + lamp.corners[1] + lamp.corners[2] + lamp.corners[3]) / 4;
  const double square = (middle - at.point).squaredNorm() + lamp.area;
  return lamp.exitance.mean() * lamp.area * rise * before / (square * square);
}

// Numbers at equal steps with one offset, u: each choice is made about as often as it is probable.
std::vector<Choice> choices(const std::vector<double>& weights, double sum, std::uint32_t count, double u) {
  std::vector<Choice> chosen;
  std::size_t next = 0;
  double before = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double wanted = (k + u) / count * sum;
    while (next + 1 < weights.size() && before + weights[next] <= wanted) before += weights[next++];
    while (next > 0 && !(weights[next] > 0)) before -= weights[--next];
    chosen.push_back({next, weights[next] > 0 ? std::clamp((wanted - before) / weights[next], 0.0, 1.0) : 0});
  }
  return chosen;
}

// The number that chooses among the lights of a point.
double offset_of(const LitPoint& point, stream::Stream purpose) {
  return pixel_sample_2d(point.sample, hash({point.seed, purpose}))[0];
}

// So many rays to a lamp, which counts `factor` times.
void add_lamp(Rays& to, const LampFace& lamp, std::size_t index, const LitPoint& point, const LampChoice& choice) {
  const std::span<const Point> corners(lamp.corners.data(), corner_count(lamp));
  const double form_factor = point_to_polygon(point.at.point, point.at.normal, corners);
  to.lamps.push_back({index, to.to_lamps.size(), choice.rays, form_factor, &lamp, choice.factor});
  const QuadPoints points(lamp.corners);
  for (std::uint32_t k = 0; k < choice.rays; ++k) {
    const std::uint32_t half = k % halves;
    const std::uint32_t rays_of_half = (choice.rays + halves - 1 - half) / halves;
    const auto u = pixel_sample_2d(point.sample * rays_of_half + k / halves, hash({choice.seed, half}));
    const Point place = points.at(u[0], u[1]);
    to.kernels.push_back(kernel(lamp, point.at, place));
    to.to_lamps.push_back({point.at.point, place, point.at.polygon, lamp.polygon});
  }
}

void add_lamps(Rays& to, const Lights& lights, std::size_t index, const LitPoint& point, std::uint32_t rays) {
  if (lights.lamps.size() <= few_lights) {
    const auto each = std::max(rays_of_lamp, rays / static_cast<std::uint32_t>(lights.lamps.size()));
    for (std::size_t l = 0; l < lights.lamps.size(); ++l) {
      if (possible_light(lights.lamps[l], point.at) > 0)
        add_lamp(to, lights.lamps[l], index, point, {each, 1, hash({point.seed, stream::place_on_lamp, l})});
    }
    return;
  }
  std::vector<double> weights;
  double sum = 0;
  for (const LampFace& lamp : lights.lamps) {
    weights.push_back(possible_light(lamp, point.at));
    sum += weights.back();
  }
  if (!(sum > 0)) return;
  const std::uint32_t count = std::max<std::uint32_t>(1, rays / rays_of_lamp);
  const std::vector<Choice> chosen = choices(weights, sum, count, offset_of(point, stream::choice_of_lamp));
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::size_t l = chosen[k].index;
    add_lamp(to, lights.lamps[l], index, point,
             {rays_of_lamp, sum / (weights[l] * count), hash({point.seed, stream::place_on_lamp, l, k})});
  }
}

void add_arrival(Rays& to, std::size_t index, const SurfacePoint& at, const Arrival& arrival, double factor) {
  if (!(arrival.irradiance > 0)) return;
  to.single.push_back(
      {index, {at.point, arrival.from, at.polygon, no_polygon}, factor * arrival.irradiance * *arrival.colour});
}

void add_luminaires(Rays& to, const Lights& lights, std::size_t index, const LitPoint& point, std::uint32_t rays) {
  const std::vector<Luminaire>& luminaires = lights.lighting.luminaires;
  std::vector<Arrival> arrivals;
  std::vector<double> weights;
  double sum = 0;
  for (std::size_t l = 0; l < luminaires.size(); ++l) {
    const auto u = pixel_sample_2d(point.sample, hash({point.seed, stream::place_on_luminaire, l}));
    arrivals.push_back(from_luminaire(luminaires[l], lights.lighting.up, point.at, {u[0], u[1]}));
    const Arrival& arrival = arrivals.back();
    weights.push_back(arrival.irradiance > 0 ? arrival.irradiance * arrival.colour->mean() : 0);
    sum += weights.back();
  }
  if (!(sum > 0)) return;
  if (luminaires.size() <= few_lights) {
    for (const Arrival& arrival : arrivals) add_arrival(to, index, point.at, arrival, 1);
    return;
  }
  const double offset = offset_of(point, stream::choice_of_luminaire);
  for (const Choice& chosen : choices(weights, sum, rays, offset))
    add_arrival(to, index, point.at, arrivals[chosen.index], sum / (weights[chosen.index] * rays));
}

// E F V of a lamp, from the rays i = 1 ... n to it with kernels g_i and the transmitted shares V_i:
//
//  E (1/n) sum_i (g_i V_i - c_i (g_i - F)),   c_i the mean V_j of the other half, of rays with g_j > 0; 1 if none.
//
// F, the form factor without shadows, is the mean of g. This is a control variate: as the coefficient is independent of
// the ray, the estimate stays unbiased. It has no variance where the whole lamp is visible, or none of it while each
// half has a ray above the horizon. Rays of one half are stratified, and so depend on each other.
double lamp_irradiance(const LampRays& rays, const Field& through, std::span<const double> kernels, Eigen::Index band) {
  const auto n = static_cast<Eigen::Index>(rays.count);
  const auto shares = through.col(band).segment(static_cast<Eigen::Index>(rays.first), n);
  const auto g = kernels.subspan(rays.first, rays.count);
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
  for (std::size_t i = 0; i < rays.count; ++i)
    sum += g[i] * shares[static_cast<Eigen::Index>(i)] - of_other[i % halves] * (g[i] - rays.form_factor);
  return rays.factor * rays.lamp->exitance[band] * sum / static_cast<double>(n);
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
  const std::vector<double>& probabilities = points_[index].aim->probabilities;
  double sum = 0;
  for (std::size_t k = 0; k < probabilities.size(); ++k) {
    if (!(probabilities[k] > 0)) continue;
    for (const std::array<Point, 3>& corners : lighting_.openings[k].triangles) {
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
  if (!point.aim->probabilities.empty()) add_targets(index);
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

Field light_samples(const Lights& lights, std::span<const LitPoint> points, std::uint32_t rays) {
  const Lighting& lighting = lights.lighting;
  Rays all;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const LitPoint& point = points[k];
    if (!lights.lamps.empty()) add_lamps(all, lights, k, point, rays);
    if (!lighting.luminaires.empty()) add_luminaires(all, lights, k, point, rays);
    if (lighting.sun) add_arrival(all, k, point.at, from_sun(lighting, point.at), 1);
  }
  Field irradiance = Field::Zero(static_cast<Eigen::Index>(points.size()), lighting.bands);
  const auto row = [&](std::size_t k) { return irradiance.row(static_cast<Eigen::Index>(k)); };

  const std::size_t to_lamps = all.to_lamps.size();
  std::vector<Segment> segments = std::move(all.to_lamps);
  for (const LightRay& ray : all.single) segments.push_back(ray.segment);
  const Field through = lighting.paths.transmittance(segments);
  for (const LampRays& lamp : all.lamps) {
    for (Eigen::Index band = 0; band < lighting.bands; ++band)
      irradiance(static_cast<Eigen::Index>(lamp.point), band) += lamp_irradiance(lamp, through, all.kernels, band);
  }
  for (std::size_t k = 0; k < all.single.size(); ++k)
    row(all.single[k].point) += all.single[k].light * through.row(static_cast<Eigen::Index>(to_lamps + k));

  if (lighting.sky) irradiance += SkySampler(lighting, points, rays).irradiance();
  return irradiance;
}

SkyAim aim_at_few(SkyAim aim, const std::vector<Opening>& openings) {
  std::vector<std::size_t> order(aim.probabilities.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return aim.probabilities[a] > aim.probabilities[b]; });
  std::size_t triangles = 0;
  for (const std::size_t k : order) {
    triangles += openings[k].triangles.size();
    if (triangles > 32) aim.probabilities[k] = 0;
  }
  return aim;
}

}  // namespace patchlight
