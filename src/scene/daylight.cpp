#include "patchlight/scene/daylight.h"

#include "light/photometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

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

std::size_t perez_class(double clearness) {
  constexpr std::array<double, 7> limits = {1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200};
  return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), clearness) - limits.begin());
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
