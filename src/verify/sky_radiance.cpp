#include "verify/sky_radiance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace patchlight {
namespace {

// Perez, Seals and Michalsky 1993, table 1. One row per class of clearness: a1 to a4, b1 to b4, up to e4.
constexpr double perez_coefficients_of_classes[8][20] = {
    {1.3525, -0.2576, -0.2690, -1.4366, -0.7670, 0.0007, 1.2734, -0.1233, 2.8000,  0.6004,
     1.2375, 1.0000,  1.8734,  0.6297,  0.9738,  0.2809, 0.0356, -0.1246, -0.5718, 0.9938},
    {-1.2219, -0.7730, 1.4148,  1.1016,  -0.2054, 0.0367, -3.9128, 0.9156, 6.9750,  0.1774,
     6.4477,  -0.1239, -1.5798, -0.5081, -1.7812, 0.1080, 0.2624,  0.0672, -0.2190, -0.4285},
    {-1.1000,  -0.2515, 0.8952,  0.0156, 0.2782, -0.1812, -4.5000, 1.1766, 24.7219, -13.0812,
     -37.7000, 34.8438, -5.0000, 1.5218, 3.9229, -2.6204, -0.0156, 0.1597, 0.4199,  -0.5562},
    {-0.5484,  -0.6654, -0.2672, 0.7117, 0.7234, -0.6219, -5.6812, 2.6297,  33.3389, -18.3000,
     -62.2500, 52.0781, -3.5000, 0.0016, 1.1477, 0.1062,  0.4659,  -0.3296, -0.0876, -0.0329},
    {-0.6000,  -0.3566, -2.5000, 2.3250,  0.2937, 0.0496, -5.6812, 1.8415, 21.0000, -4.7656,
     -21.5906, 7.2492,  -3.5000, -0.1554, 1.4062, 0.3988, 0.0032,  0.0766, -0.0656, -0.1294},
    {-1.0156, -0.3670, 1.0078,  1.4051,  0.2875,  -0.5328, -3.8500, 3.3750, 14.0000, -0.9999,
     -7.1406, 7.5469,  -3.4000, -0.1078, -1.0750, 1.5702,  -0.0672, 0.4016, 0.3017,  -0.4844},
    {-1.0000, 0.0211,  0.5025,  -0.5119, -0.3000, 0.1922, 0.7023, -1.6317, 19.0000, -5.0000,
     1.2438,  -1.9094, -4.0000, 0.0250,  0.3844,  0.2656, 1.0468, -0.3788, -2.4517, 1.4656},
    {-1.0500,  0.0289,  0.4260,  0.3590, -0.3250, 0.1156, 0.7781, 0.0025,  31.0625, -14.5000,
     -46.1148, 55.3750, -7.2312, 0.4050, 13.3500, 0.6234, 1.5000, -0.6426, 1.8564,  0.5636}};

// The brightness that the fit takes: from 0.01 (0.2 for the clearnesses 1.065 to 2.8) to 0.6, and not beyond the first
// value at which the gradation 1 + a exp(b / cos zeta) grows without bound towards the horizon.
double brightness_of_fit(const double* x, std::size_t row, double brightness, double zenith) {
  double fit = std::min(std::max(brightness, row >= 1 && row <= 4 ? 0.2 : 0.01), 0.6);
  const double a = x[0] + x[1] * zenith;
  const double b = x[4] + x[5] * zenith;
  const double a_slope = x[2] + x[3] * zenith;
  const double b_slope = x[6] + x[7] * zenith;
  if (a + fit * a_slope > 0 && b + fit * b_slope > 0)
    fit = std::max(a_slope > 0 ? -a / a_slope : 0.01, b_slope > 0 ? -b / b_slope : 0.01);
  return fit;
}

// Equations 3 to 7 of the paper, with the sun's zenith angle in radians.
std::array<double, 5> perez_sky(double clearness, double stated_brightness, double zenith) {
  const std::size_t row = perez_class(clearness);
  const double* const x = perez_coefficients_of_classes[row];
  const double brightness = brightness_of_fit(x, row, stated_brightness, zenith);
  std::array<double, 5> sky{};
  for (std::size_t k = 0; k < sky.size(); ++k)
    sky[k] = x[4 * k] + x[4 * k + 1] * zenith + brightness * (x[4 * k + 2] + x[4 * k + 3] * zenith);
  if (row == 0) {
    sky[2] = std::exp(std::pow(brightness * (x[8] + x[9] * zenith), x[10])) - x[11];
    sky[3] = -std::exp(brightness * (x[12] + x[13] * zenith)) + x[14] + brightness * x[15];
  }
  return sky;
}

}  // namespace

SkyRadiance::SkyRadiance(const Sky& sky, const Vector& up) : kind_(sky.kind), up_(up), sun_(sky.sun_direction) {
  // ISO 15469: the CIE clear sky is 0.91 + 10 exp(-3 gamma) + 0.45 cos^2 gamma, times 1 - exp(-0.32 / cos zeta).
  if (kind_ == SkyKind::cie_clear) coefficients_ = {-1, -0.32, 10 / 0.91, -3, 0.45 / 0.91};
  if (kind_ == SkyKind::perez)
    coefficients_ = perez_sky(sky.clearness, sky.brightness, std::acos(std::clamp(sun_.dot(up), 0.0, 1.0)));
  // A fit without light, far outside its data, counts as a uniform sky.
  if (!(relative(up) > 0 && relative_horizontal_irradiance() > 0)) kind_ = SkyKind::uniform;
  scale_ = sky.horizontal_irradiance.size() > 0 ? Spectrum(sky.horizontal_irradiance / relative_horizontal_irradiance())
                                                : Spectrum(sky.zenith_radiance / relative(up));
  ground_ = sky.ground_radiance.size() > 0 ? sky.ground_radiance : Spectrum(Spectrum::Zero(scale_.size()));
}

double SkyRadiance::relative(const Vector& direction) const {
  const double sine = up_.dot(direction);
  if (kind_ == SkyKind::uniform) return 1;
  if (kind_ == SkyKind::cie_overcast) return (1 + 2 * std::max(sine, 0.0)) / 3;
  // The exponent has a pole at the horizon; the fit ends above it.
  constexpr double min_sine = 0.01;
  const auto& [a, b, c, d, e] = coefficients_;
  const double gamma = std::atan2(sun_.cross(direction).norm(), sun_.dot(direction));
  const double cosine = std::cos(gamma);
  const double gradation = 1 + a * std::exp(b / std::max(sine, min_sine));
  return std::max(0.0, gradation * (1 + c * std::exp(d * gamma) + e * cosine * cosine));
}

// The midpoint rule in polar coordinates around the sun, where the radiance varies most.
double SkyRadiance::relative_horizontal_irradiance() const {
  constexpr int steps = 600;
  constexpr double pi = std::numbers::pi;
  const Vector across = sun_.unitOrthogonal();
  const Vector aside = sun_.cross(across);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double polar = pi * (i + 0.5) / steps;
    for (int j = 0; j < steps; ++j) {
      const double turn = 2 * pi * (j + 0.5) / steps;
      const Vector direction =
          std::cos(polar) * sun_ + std::sin(polar) * (std::cos(turn) * across + std::sin(turn) * aside);
      const double sine = up_.dot(direction);
      if (sine > 0) sum += relative(direction) * sine * std::sin(polar);
    }
  }
  return sum * (pi / steps) * (2 * pi / steps);
}

Spectrum SkyRadiance::radiance_from(const Vector& direction) const {
  return up_.dot(direction) < 0 ? ground_ : Spectrum(relative(direction) * scale_);
}

}  // namespace patchlight
