#include "render/light_samples.h"

#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "render/pixel_samples.h"
#include "render/sky_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// So many lamps or luminaires get rays each; of more, some are chosen for each point.
constexpr std::size_t few_lights = 4;

// A lamp that is chosen gets so many, each of which says how the other counts.
constexpr std::uint32_t rays_of_lamp = 2;

// Rays to a lamp are in two halves, by turns, whose random numbers have nothing to do with each other.
constexpr std::uint32_t halves = 2;

// Seeds of what one point asks for.
enum Purpose : std::uint32_t { choice_of_lamp = 11, place_on_lamp, choice_of_luminaire, place_on_luminaire };

// A ray to a place on a light. What arrives is a constant plus `light` times the share that gets through.
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

// Nearly what a lamp may give, mean of the bands: above 0 wherever it is before the point and the point before it.
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

std::array<double, 4> sample_of(const LitPoint& point, Purpose purpose, std::uint32_t ray, std::uint32_t rays) {
  return pixel_sample(point.sample * rays + ray, hash({point.seed, purpose}));
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
        add_lamp(to, lights.lamps[l], index, point, {each, 1, hash({point.seed, place_on_lamp, l})});
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
  const std::vector<Choice> chosen = choices(weights, sum, count, sample_of(point, choice_of_lamp, 0, 1)[0]);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::size_t l = chosen[k].index;
    add_lamp(to, lights.lamps[l], index, point,
             {rays_of_lamp, sum / (weights[l] * count), hash({point.seed, place_on_lamp, l, k})});
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
    const auto u = pixel_sample(point.sample, hash({point.seed, place_on_luminaire, l}));
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
  const double offset = sample_of(point, choice_of_luminaire, 0, 1)[0];
  for (const Choice& chosen : choices(weights, sum, rays, offset))
    add_arrival(to, index, point.at, arrivals[chosen.index], sum / (weights[chosen.index] * rays));
}

// E F V of a lamp, from the rays i = 1 ... n to it with kernels g_i and the shares V_i that get through:
//
//   E (1/n) sum_i (g_i V_i - c_i (g_i - F)),   c_i the mean V_j of the other half, of rays with g_j > 0; 1 if none.
//
// F, the form factor without shadows, is the mean of g: a control variate whose coefficient is independent of the ray
// keeps the mean, and leaves no variance where the lamp is seen as a whole, or not at all and each half has a ray above
// the horizon. Rays of one half are spread evenly, and so depend on each other.
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

}  // namespace

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

  if (lighting.sky) irradiance += sky_samples(lighting, points, rays);
  return irradiance;
}

}  // namespace patchlight
