#include "verify/photometry.h"

#include "scene/photometric_web.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace patchlight {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

// The angle between two unit vectors; accurate for small angles.
double angle_between(const Vector& a, const Vector& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * degrees; }

// A value at an angle as a weighted mean of two neighbours in a table.
struct Neighbours {
  std::size_t below = 0;
  std::size_t above = 0;
  double weight_above = 0;
};

// Angles outside the table take its nearest end.
Neighbours neighbours_in(const std::vector<double>& angles, double angle) {
  std::size_t above = 0;
  while (above + 1 < angles.size() && angles[above] < angle) ++above;
  if (above == 0 || angle >= angles.back()) return {above, above, 0};
  return {above - 1, above, (angle - angles[above - 1]) / (angles[above] - angles[above - 1])};
}

bool is_outside(const std::vector<double>& angles, double angle) {
  constexpr double rounding_of_degrees = 1e-6;
  return angle < angles.front() - rounding_of_degrees || angle > angles.back() + rounding_of_degrees;
}

struct WebAngles {
  double vertical = 0;
  double horizontal = 0;
};

// IES LM-63: type C measures the vertical angle from the aim; types A and B measure both angles from it.
WebAngles web_angles(PhotometricType type, const Luminaire& luminaire, const Vector& direction) {
  const double x = luminaire.zero_plane.dot(direction);
  const double y = luminaire.zero_plane.cross(luminaire.aim).dot(direction);
  const double z = luminaire.aim.dot(direction);
  switch (type) {
    case PhotometricType::a:
      return {std::asin(std::clamp(x, -1.0, 1.0)) * degrees, std::atan2(-y, z) * degrees};
    case PhotometricType::b:
      return {std::atan2(x, z) * degrees, std::asin(std::clamp(-y, -1.0, 1.0)) * degrees};
    case PhotometricType::c:
      break;
  }
  const double turn = std::atan2(y, x) * degrees;
  return {angle_between(luminaire.aim, direction), turn < 0 ? turn + 360 : turn};
}

// Section 5.13 of LM-63-02: tables of less than a full turn are continued by their symmetry.
double fold_horizontal(const PhotometricWeb& web, double angle) {
  const double first = std::round(web.horizontal.front());
  const double last = std::round(web.horizontal.back());
  if (web.type != PhotometricType::c) return first < 0 ? angle : std::abs(angle);
  if (first == 90 && last == 270) return angle < 90 ? 180 - angle : angle > 270 ? 540 - angle : angle;
  if (last > 180) return angle;
  const double of_half = std::min(angle, 360 - angle);
  return last > 90 ? of_half : std::min(of_half, 180 - of_half);
}

double candela_in(const PhotometricWeb& web, const Luminaire& luminaire, const Vector& direction) {
  WebAngles angles = web_angles(web.type, luminaire, direction);
  if (is_outside(web.vertical, angles.vertical)) return 0;
  const bool is_round = web.horizontal.size() == 1;
  angles.horizontal = is_round ? web.horizontal.front() : fold_horizontal(web, angles.horizontal);
  if (is_outside(web.horizontal, angles.horizontal)) return 0;
  const Neighbours v = neighbours_in(web.vertical, angles.vertical);
  const Neighbours h = neighbours_in(web.horizontal, angles.horizontal);
  const auto on_plane = [&](std::size_t plane) {
    const std::size_t row = plane * web.vertical.size();
    return (1 - v.weight_above) * web.candela[row + v.below] + v.weight_above * web.candela[row + v.above];
  };
  return (1 - h.weight_above) * on_plane(h.below) + h.weight_above * on_plane(h.above);
}

double tilt_in(const PhotometricWeb& web, double tilt) {
  if (web.tilt.empty()) return 1;
  const Neighbours at = neighbours_in(web.tilt, tilt);
  return (1 - at.weight_above) * web.tilt_factor[at.below] + at.weight_above * web.tilt_factor[at.above];
}

// 2^-(angle / beam)^p, with p such that a tenth is left at the field angle.
double spot_falloff(const SpotLight& spot, double angle) {
  const double p = std::log(std::log2(10.0)) / std::log(spot.field_half_angle / spot.beam_half_angle);
  return std::exp2(-std::pow(angle / spot.beam_half_angle, p));
}

}  // namespace

Spectrum radiant_intensity(const Luminaire& luminaire, const Vector& up, const Vector& direction) {
  if (const auto* point = std::get_if<PointLight>(&luminaire.light)) return point->intensity;
  if (const auto* spot = std::get_if<SpotLight>(&luminaire.light))
    return spot_falloff(*spot, angle_between(luminaire.aim, direction)) * spot->intensity;
  const auto& measured = std::get<WebLight>(luminaire.light);
  const double tilt = angle_between(luminaire.aim, -up);
  return tilt_in(*measured.web, tilt) * candela_in(*measured.web, luminaire, direction) * measured.watts_per_lumen;
}

}  // namespace patchlight
