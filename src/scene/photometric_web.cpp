#include "scene/photometric_web.h"

#include "patchlight/scene/daylight.h"

#include "light/photometry.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

// Rounding of an angle; degrees.
constexpr double angle_tolerance = 1e-6;

struct Angles {
  double vertical = 0;
  double horizontal = 0;
};

// The formulas of PhotometricType the other way round.
Angles angles_of(PhotometricType type, const LuminaireFrame& frame, const Vector& direction) {
  const double ahead = frame.aim.dot(direction);
  const double along = frame.zero_plane.dot(direction);
  const double aside = frame.zero_plane.cross(frame.aim).dot(direction);
  const auto arc = [](double y, double x) { return std::atan2(y, x) * (180 / std::numbers::pi); };
  if (type == PhotometricType::a) return {arc(along, std::hypot(ahead, aside)), arc(-aside, ahead)};
  if (type == PhotometricType::b) return {arc(along, ahead), arc(-aside, std::hypot(ahead, along))};
  return {arc(std::hypot(along, aside), ahead), arc(aside, along)};
}

// A horizontal angle between -180 and 180 as the one of the table that is alike.
double by_symmetry(const PhotometricWeb& web, double angle) {
  const double first = web.horizontal.front();
  const double last = web.horizontal.back();
  if (web.type != PhotometricType::c) return first >= 0 ? std::abs(angle) : angle;
  const bool about_quarter = first > 90 - angle_tolerance && last > 180;
  if (about_quarter) {
    // The halves on both sides of the plane through 90 and 270 degrees are alike.
    const double from_quarter = std::abs(angle - 90) <= 180 ? std::abs(angle - 90) : 360 - std::abs(angle - 90);
    return 90 + from_quarter;
  }
  if (last > 180 + angle_tolerance) return angle < 0 ? angle + 360 : angle;
  const double half = std::abs(angle);
  return last > 90 + angle_tolerance ? half : std::min(half, 180 - half);
}

// Where an angle lies in ascending ones: between `index` and the next, at `share` of the way.
struct Position {
  std::size_t index = 0;
  double share = 0;
  bool inside = true;
};

Position position_of(const std::vector<double>& angles, double angle) {
  const bool inside = angle >= angles.front() - angle_tolerance && angle <= angles.back() + angle_tolerance;
  if (angles.size() < 2) return {0, 0, inside};
  const auto above = std::upper_bound(angles.begin() + 1, angles.end() - 1, angle);
  const auto index = static_cast<std::size_t>(above - angles.begin()) - 1;
  return {index, std::clamp((angle - angles[index]) / (angles[index + 1] - angles[index]), 0.0, 1.0), inside};
}

// Coefficients of a luminous efficacy, lm/W, for one class of clearness. Perez et al. 1990, table 4.
struct Efficacy {
  double a, b, c, d;
};

constexpr std::array<Efficacy, 8> diffuse_efficacies = {{{97.24, -0.46, 12.00, -8.91},
                                                         {107.22, 1.15, 0.59, -3.95},
                                                         {104.97, 2.96, -5.53, -8.77},
                                                         {102.39, 5.59, -13.95, -13.90},
                                                         {100.71, 5.94, -22.75, -23.74},
                                                         {106.42, 3.83, -36.15, -28.83},
                                                         {141.88, 1.90, -53.24, -14.03},
                                                         {152.23, 0.35, -45.27, -7.98}}};

constexpr std::array<Efficacy, 8> direct_efficacies = {{{57.20, -4.55, -2.98, 117.12},
                                                        {98.99, -3.46, -1.21, 12.38},
                                                        {109.83, -4.90, -1.71, -8.81},
                                                        {110.34, -5.84, -1.99, -4.56},
                                                        {106.36, -3.97, -1.75, -6.16},
                                                        {107.19, -1.25, -1.51, -26.73},
                                                        {105.75, 0.77, -1.26, -34.44},
                                                        {101.18, 1.58, -1.10, -8.29}}};

// On a plane across the sun's rays outside the atmosphere, W/m^2. Duffie and Beckman 2013, eq. 1.4.1a, with the solar
// constant that Perez et al. use.
double extraterrestrial_irradiance(int day_of_year) {
  return 1367 * (1 + 0.033 * std::cos(2 * std::numbers::pi * day_of_year / 365));
}

// The atmosphere on the sun's way, relative to the zenith. Kasten and Young 1989.
double air_mass(double altitude_degrees) {
  return 1 / (std::sin(altitude_degrees * std::numbers::pi / 180) +
              0.50572 * std::pow(altitude_degrees + 6.07995, -1.6364));
}

// The state of the sky. Perez et al. 1990, eqs. 1 and 2.
struct SkyState {
  double zenith_angle = 0;  // of the sun, radians
  double clearness = 1;
  double brightness = 0;
};

SkyState sky_state(double direct_normal, const SolarIrradiance& measured, double sine_of_altitude) {
  const double zenith_angle = std::acos(sine_of_altitude);
  const double cube = 1.041 * zenith_angle * zenith_angle * zenith_angle;
  const double diffuse = measured.diffuse_horizontal;
  const double altitude = 90 - zenith_angle * 180 / std::numbers::pi;
  return {zenith_angle, ((diffuse + direct_normal) / diffuse + cube) / (1 + cube),
          diffuse * air_mass(altitude) / extraterrestrial_irradiance(measured.day_of_year)};
}

// Eq. 7, lm/W.
double diffuse_efficacy(const SkyState& state, double water) {
  const Efficacy& of = diffuse_efficacies[perez_class(state.clearness)];
  return std::max(0.0, of.a + of.b * water + of.c * std::cos(state.zenith_angle) + of.d * std::log(state.brightness));
}

// Eq. 8, lm/W.
double direct_efficacy(const SkyState& state, double water) {
  const Efficacy& of = direct_efficacies[perez_class(state.clearness)];
  return std::max(0.0, of.a + of.b * water + of.c * std::exp(5.73 * state.zenith_angle - 5) + of.d * state.brightness);
}

// W/m^2 of visible light.
Spectrum visible(double irradiance, double efficacy, Eigen::Index bands) {
  return Spectrum::Constant(bands, irradiance * efficacy / luminous_efficacy);
}

}  // namespace

double spot_profile(const SpotLight& spot, double cosine) {
  assert(0 < spot.beam_half_angle && spot.beam_half_angle < spot.field_half_angle);
  // 2^-(field / beam)^p = 1 / 10
  const double exponent = std::log(std::log2(10.0)) / std::log(spot.field_half_angle / spot.beam_half_angle);
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
  return std::exp2(-std::pow(angle / spot.beam_half_angle, exponent));
}

double spot_solid_angle(const SpotLight& spot) {
  // 2 pi integral of the profile over cos, by the midpoint rule in the angle: 400 steps across the beam's half angle.
  const int steps = static_cast<int>(400 * 180 / spot.beam_half_angle);
  double sum = 0;
  for (int k = 0; k < steps; ++k) {
    const double angle = std::numbers::pi * (k + 0.5) / steps;
    sum += spot_profile(spot, std::cos(angle)) * std::sin(angle);
  }
  return 2 * std::numbers::pi * sum * std::numbers::pi / steps;
}

double candela(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction) {
  const Angles angles = angles_of(web.type, frame, direction);
  const Position v = position_of(web.vertical, angles.vertical);
  // With one horizontal angle the intensity is the same all around.
  const bool round = web.horizontal.size() == 1;
  const Position h = round ? Position{} : position_of(web.horizontal, by_symmetry(web, angles.horizontal));
  if (!v.inside || !h.inside) return 0;
  const auto at = [&](std::size_t column) {
    const auto row = web.candela.begin() + static_cast<std::ptrdiff_t>(column * web.vertical.size() + v.index);
    return v.share > 0 ? (1 - v.share) * row[0] + v.share * row[1] : row[0];
  };
  return h.share > 0 ? (1 - h.share) * at(h.index) + h.share * at(h.index + 1) : at(h.index);
}

double tilt_factor(const PhotometricWeb& web, double tilt_degrees) {
  if (web.tilt.empty()) return 1;
  const Position at = position_of(web.tilt, tilt_degrees);
  const double below = web.tilt_factor[at.index];
  return at.share > 0 ? below + at.share * (web.tilt_factor[at.index + 1] - below) : below;
}

double luminous_flux(const PhotometricWeb& web) {
  const LuminaireFrame frame{-Vector::UnitZ(), Vector::UnitX()};
  constexpr int rings = 360;  // half a degree each
  double flux = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const double polar = std::numbers::pi * (ring + 0.5) / rings;
    double sum = 0;
    for (int k = 0; k < 2 * rings; ++k) {
      const double turn = std::numbers::pi * (k + 0.5) / rings;
      sum += candela(web, frame,
                     Vector(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), -std::cos(polar)));
    }
    flux += sum * std::sin(polar);
  }
  return flux * (std::numbers::pi / rings) * (std::numbers::pi / rings);
}

double projected_opening(const PhotometricWeb& web, const LuminaireFrame& frame, const Vector& direction) {
  constexpr double quarter_pi = std::numbers::pi / 4;
  // Width, length and height, and the cosines between the direction and each.
  const Vector& sizes = web.opening;
  const Vector cosines = Vector(direction.dot(frame.zero_plane.cross(frame.aim)), direction.dot(frame.zero_plane),
                                direction.dot(frame.aim))
                             .cwiseAbs();
  // The projected area of an elliptical cylinder along an axis: its ends and its side.
  const auto of_cylinder = [&](int axis) {
    const int p = (axis + 1) % 3, q = (axis + 2) % 3;
    return quarter_pi * sizes[p] * sizes[q] * cosines[axis] +
           sizes[axis] * std::hypot(sizes[p] * cosines[q], sizes[q] * cosines[p]);
  };
  const Vector faces(sizes[1] * sizes[2] * cosines[0], sizes[0] * sizes[2] * cosines[1],
                     sizes[0] * sizes[1] * cosines[2]);
  switch (web.shape) {
    case OpeningShape::box:
      return faces.sum();
    case OpeningShape::upright_cylinder:
      return of_cylinder(2);
    case OpeningShape::cylinder_by_length:
      return of_cylinder(1);
    case OpeningShape::cylinder_by_width:
      return of_cylinder(0);
    case OpeningShape::ellipsoid:
      return quarter_pi * faces.norm();
  }
  return 0;
}

std::size_t perez_class(double clearness) {
  constexpr std::array<double, 7> limits = {1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200};
  return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), clearness) - limits.begin());
}

Spectrum irradiance_of_ground(const Daylight& daylight, const Vector& up, Eigen::Index bands) {
  Spectrum irradiance = Spectrum::Zero(bands);
  if (daylight.sky) irradiance += daylight.sky->horizontal_irradiance;
  if (daylight.sun) irradiance += std::max(0.0, daylight.sun->direction.dot(up)) * daylight.sun->normal_irradiance;
  return irradiance;
}

Daylight above_ground(Daylight daylight, double reflectance, const Vector& up, Eigen::Index bands) {
  if (daylight.sky)
    daylight.sky->ground_radiance = reflectance / std::numbers::pi * irradiance_of_ground(daylight, up, bands);
  return daylight;
}

Daylight measured_daylight(const SolarIrradiance& measured, const Vector& sun_direction, const Vector& up,
                           Eigen::Index bands) {
  const double sine = std::clamp(sun_direction.dot(up), 0.0, 1.0);
  const double direct = sine > 0 ? measured.direct_normal : 0;
  const double water = measured.precipitable_water;
  Daylight daylight;
  if (!(measured.diffuse_horizontal > 0)) {
    // Nothing is scattered: the air is as clear as can be.
    const double efficacy = direct_efficacies.back().a;
    if (direct > 0) daylight.sun = Sun{sun_direction, visible(direct, efficacy, bands)};
    return daylight;
  }
  const SkyState state = sky_state(direct, measured, sine);
  const double diffuse = measured.diffuse_horizontal;
  daylight.sky = Sky{.kind = sine > 0 ? SkyKind::perez : SkyKind::uniform,
                     .horizontal_irradiance = visible(diffuse, diffuse_efficacy(state, water), bands),
                     .sun_direction = sun_direction,
                     .clearness = state.clearness,
                     .brightness = state.brightness};
  if (direct > 0) daylight.sun = Sun{sun_direction, visible(direct, direct_efficacy(state, water), bands)};
  return daylight;
}

}  // namespace patchlight
