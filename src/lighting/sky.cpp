#include "lighting/sky.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

// Perez, Seals and Michalsky 1993, table 1: for each class of clearness a1 to a4, b1 to b4, up to e4.
using PerezRow = std::array<std::array<double, 4>, 5>;
constexpr std::array<PerezRow, 8> perez_table = {{
    {{{1.3525, -0.2576, -0.2690, -1.4366},
      {-0.7670, 0.0007, 1.2734, -0.1233},
      {2.8000, 0.6004, 1.2375, 1.0000},
      {1.8734, 0.6297, 0.9738, 0.2809},
      {0.0356, -0.1246, -0.5718, 0.9938}}},
    {{{-1.2219, -0.7730, 1.4148, 1.1016},
      {-0.2054, 0.0367, -3.9128, 0.9156},
      {6.9750, 0.1774, 6.4477, -0.1239},
      {-1.5798, -0.5081, -1.7812, 0.1080},
      {0.2624, 0.0672, -0.2190, -0.4285}}},
    {{{-1.1000, -0.2515, 0.8952, 0.0156},
      {0.2782, -0.1812, -4.5000, 1.1766},
      {24.7219, -13.0812, -37.7000, 34.8438},
      {-5.0000, 1.5218, 3.9229, -2.6204},
      {-0.0156, 0.1597, 0.4199, -0.5562}}},
    {{{-0.5484, -0.6654, -0.2672, 0.7117},
      {0.7234, -0.6219, -5.6812, 2.6297},
      {33.3389, -18.3000, -62.2500, 52.0781},
      {-3.5000, 0.0016, 1.1477, 0.1062},
      {0.4659, -0.3296, -0.0876, -0.0329}}},
    {{{-0.6000, -0.3566, -2.5000, 2.3250},
      {0.2937, 0.0496, -5.6812, 1.8415},
      {21.0000, -4.7656, -21.5906, 7.2492},
      {-3.5000, -0.1554, 1.4062, 0.3988},
      {0.0032, 0.0766, -0.0656, -0.1294}}},
    {{{-1.0156, -0.3670, 1.0078, 1.4051},
      {0.2875, -0.5328, -3.8500, 3.3750},
      {14.0000, -0.9999, -7.1406, 7.5469},
      {-3.4000, -0.1078, -1.0750, 1.5702},
      {-0.0672, 0.4016, 0.3017, -0.4844}}},
    {{{-1.0000, 0.0211, 0.5025, -0.5119},
      {-0.3000, 0.1922, 0.7023, -1.6317},
      {19.0000, -5.0000, 1.2438, -1.9094},
      {-4.0000, 0.0250, 0.3844, 0.2656},
      {1.0468, -0.3788, -2.4517, 1.4656}}},
    {{{-1.0500, 0.0289, 0.4260, 0.3590},
      {-0.3250, 0.1156, 0.7781, 0.0025},
      {31.0625, -14.5000, -46.1148, 55.3750},
      {-7.2312, 0.4050, 13.3500, 0.6234},
      {1.5000, -0.6426, 1.8564, 0.5636}}},
}};

// (1 - exp(-0.32 / cos zeta)) (0.91 + 10 exp(-3 gamma) + 0.45 cos^2 gamma), the second factor over 0.91.
constexpr std::array<double, 5> cie_clear_coefficients = {-1, -0.32, 10 / 0.91, -3, 0.45 / 0.91};

// A coefficient as a line over the brightness: at_zero + slope * brightness.
struct BrightnessLine {
  double at_zero, slope;

  double at(double brightness) const { return at_zero + slope * brightness; }
  // Where the line ends to be above 0, on the way down from a brightness where it is.
  double lower_end() const { return slope > 0 ? -at_zero / slope : 0; }
};

BrightnessLine line_of(const std::array<double, 4>& x, double sun_zenith_angle) {
  return {x[0] + x[1] * sun_zenith_angle, x[2] + x[3] * sun_zenith_angle};
}

// The brightness at which the table holds. Radiance's gendaylit takes 0.01 to 0.6, and at least 0.2 for a clearness of
// 1.065 to 2.8, where the fit has no darker skies. Where both a and b are above 0, a exp(b / cos zeta) has no bound
// towards the horizon: the brightness is lowered until one of them is 0.
double valid_brightness(double clearness, double brightness, double sun_zenith_angle) {
  const std::size_t category = perez_class(clearness);
  const double lowest = category > 0 && category < 5 ? 0.2 : 0.01;
  const double valid = std::clamp(brightness, lowest, 0.6);
  const BrightnessLine a = line_of(perez_table[category][0], sun_zenith_angle);
  const BrightnessLine b = line_of(perez_table[category][1], sun_zenith_angle);
  if (a.at(valid) <= 0 || b.at(valid) <= 0) return valid;
  return std::max({lowest, a.lower_end(), b.lower_end()});
}

// Perez et al. 1993, eqs. 4 to 7.
std::array<double, 5> perez_coefficients(double clearness, double stated_brightness, double sun_zenith_angle) {
  const std::size_t category = perez_class(clearness);
  const double brightness = valid_brightness(clearness, stated_brightness, sun_zenith_angle);
  const PerezRow& x = perez_table[category];
  std::array<double, 5> coefficients{};
  for (std::size_t k = 0; k < 5; ++k) coefficients[k] = line_of(x[k], sun_zenith_angle).at(brightness);
  if (category > 0) return coefficients;
  const auto& c = x[2];
  const auto& d = x[3];
  coefficients[2] = std::exp(std::pow(brightness * (c[0] + c[1] * sun_zenith_angle), c[2])) - c[3];
  coefficients[3] = -std::exp(brightness * (d[0] + d[1] * sun_zenith_angle)) + d[2] + brightness * d[3];
  return coefficients;
}

// The irradiance of a horizontal plane, for a color of 1: the integral of the relative radiance times sin h over the
// hemisphere, by the midpoint rule in altitude h and azimuth.
double horizontal_irradiance(const SkyModel& sky) {
  constexpr int steps = 400;
  const Vector across = sky.up.unitOrthogonal();
  const Vector aside = sky.up.cross(across);
  double sum = 0;
  for (int ring = 0; ring < steps; ++ring) {
    const double altitude = std::numbers::pi / 2 * (ring + 0.5) / steps;
    double around = 0;
    for (int turn = 0; turn < steps; ++turn) {
      const double azimuth = 2 * std::numbers::pi * (turn + 0.5) / steps;
      around += relative_radiance(sky, std::sin(altitude) * sky.up + std::cos(altitude) * (std::cos(azimuth) * across +
                                                                                           std::sin(azimuth) * aside));
    }
    sum += around * std::sin(altitude) * std::cos(altitude);
  }
  return sum * (std::numbers::pi / 2 / steps) * (2 * std::numbers::pi / steps);
}

}  // namespace

double relative_radiance(const SkyModel& sky, const Vector& direction) {
  const double sine = direction.dot(sky.up);
  if (sky.kind == SkyKind::uniform) return 1;
  if (sky.kind == SkyKind::cie_overcast) return (1 + 2 * std::max(0.0, sine)) / 3;
  // At the horizon 1 / cos zeta has no bound; the fit ends at some degrees above it.
  const auto& [a, b, c, d, e] = sky.coefficients;
  const double cosine = std::clamp(direction.dot(sky.sun_direction), -1.0, 1.0);
  const double gradation = 1 + a * std::exp(b / std::max(sine, 0.01));
  const double indicatrix = 1 + c * std::exp(d * std::acos(cosine)) + e * cosine * cosine;
  return std::max(0.0, gradation * indicatrix);
}

SkyModel relative_sky(const Sky& sky, const Vector& up) {
  SkyModel model{.kind = sky.kind,
                 .up = up,
                 .sun_direction = sky.sun_direction,
                 .coefficients = {},
                 .colour = Spectrum::Ones(1),
                 .ground = Spectrum::Zero(1)};
  if (sky.kind == SkyKind::cie_clear) model.coefficients = cie_clear_coefficients;
  if (sky.kind == SkyKind::perez) {
    const double sun_zenith_angle = std::acos(std::clamp(sky.sun_direction.dot(up), 0.0, 1.0));
    model.coefficients = perez_coefficients(sky.clearness, sky.brightness, sun_zenith_angle);
  }
  // Outside its data the fit can have no light anywhere.
  if (!(relative_radiance(model, up) > 0 && horizontal_irradiance(model) > 0)) model.kind = SkyKind::uniform;
  return model;
}

SkyModel sky_model(const Sky& sky, const Vector& up) {
  assert(sky.horizontal_irradiance.size() > 0 || sky.zenith_radiance.size() > 0);
  SkyModel model = relative_sky(sky, up);
  if (sky.horizontal_irradiance.size() > 0) {
    model.colour = sky.horizontal_irradiance / horizontal_irradiance(model);
  } else {
    model.colour = sky.zenith_radiance / relative_radiance(model, up);
  }
  model.ground = sky.ground_radiance.size() > 0 ? sky.ground_radiance : Spectrum(Spectrum::Zero(model.colour.size()));
  return model;
}

Spectrum radiance(const SkyModel& sky, const Vector& direction) {
  if (direction.dot(sky.up) < 0) return sky.ground;
  return relative_radiance(sky, direction) * sky.colour;
}

}  // namespace patchlight
