#include "light/photometry.h"

#include "base/tolerances.h"
#include "light/spectra.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace patchlight {

double luminance(const Spectrum& radiance, const Bands& bands) {
  assert(static_cast<std::size_t>(radiance.size()) == bands.size());
  double visible = 0;
  for (std::size_t band = 0; band < bands.size(); ++band)
    visible += bands[band].luminous_weight * radiance[static_cast<Eigen::Index>(band)];
  return luminous_efficacy * visible;
}

Spectrum luminous_shares(const Bands& bands) {
  Spectrum weights(static_cast<Eigen::Index>(bands.size()));
  double sum = 0;
  for (std::size_t band = 0; band < bands.size(); ++band)
    sum += weights[static_cast<Eigen::Index>(band)] = bands[band].luminous_weight;
  // The weights of colors sum up to 1 as they are, up to rounding.
  return std::abs(sum - 1) <= tolerance_of_shapes || !(sum > 0) ? weights : Spectrum(weights / sum);
}

double luminance(const Spectrum& radiance) { return luminance(radiance, usual_bands(radiance.size())); }

Bands usual_bands(Eigen::Index number) {
  // ITU-R Recommendation BT.709.
  if (number == 3) return {{"r", 0.2126, {1, 0, 0}}, {"g", 0.7152, {0, 1, 0}}, {"b", 0.0722, {0, 0, 1}}};
  Bands bands;
  const double part = 1 / static_cast<double>(number);
  for (Eigen::Index band = 1; band <= number; ++band) bands.push_back({std::to_string(band), part, {part, part, part}});
  return bands;
}

namespace {

// Chromaticity in the CIE 1960 diagram.
Eigen::Vector2d uv_of(const Eigen::Vector3d& xyz) {
  return Eigen::Vector2d(4 * xyz.x(), 6 * xyz.y()) / (xyz.x() + 15 * xyz.y() + 3 * xyz.z());
}

constexpr double coldest = 1000;  // K
constexpr double hottest = 50000;
constexpr int steps = 400;  // of one ratio, 1 %

double temperature_of(double step) { return coldest * std::pow(hottest / coldest, step / steps); }

const std::vector<Eigen::Vector2d>& planckian_locus() {
  static const std::vector<Eigen::Vector2d> locus = [] {
    std::vector<Eigen::Vector2d> places;
    for (int k = 0; k <= steps; ++k)
      places.push_back(uv_of(xyz_of_cells(in_cells(*planckian_spectrum(temperature_of(k)), Beyond::zero))));
    return places;
  }();
  return locus;
}

double degrees_of(double radians) { return radians * 180 / std::numbers::pi; }
double radians_of(double degrees) { return degrees * std::numbers::pi / 180; }

// The hue angle in degrees, 0 to 360; 0 of a gray.
double hue_of(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double hue = degrees_of(std::atan2(b, a));
  return hue < 0 ? hue + 360 : hue;
}

double seventh_share(double chroma) {
  const double power = std::pow(chroma, 7);
  return std::sqrt(power / (power + std::pow(25.0, 7)));
}

double hue_difference(double from, double to) {
  const double difference = to - from;
  if (difference > 180) return difference - 360;
  return difference < -180 ? difference + 360 : difference;
}

double mean_hue(double a, double b) {
  if (std::abs(a - b) <= 180) return (a + b) / 2;
  return (a + b + (a + b < 360 ? 360 : -360)) / 2;
}

}  // namespace

Eigen::Vector3d xyz_of(const Spectrum& radiance, const Bands& bands) {
  assert(static_cast<std::size_t>(radiance.size()) == bands.size());
  Eigen::Vector3d rgb = Eigen::Vector3d::Zero();
  for (std::size_t band = 0; band < bands.size(); ++band)
    rgb += radiance[static_cast<Eigen::Index>(band)] * Eigen::Vector3d(bands[band].rgb.data());
  return luminous_efficacy * (xyz_from_rgb() * rgb);
}

std::optional<double> correlated_colour_temperature(const Eigen::Vector3d& xyz) {
  if (!(xyz.y() > 0) || !xyz.allFinite()) return std::nullopt;
  const Eigen::Vector2d place = uv_of(xyz);
  const std::vector<Eigen::Vector2d>& locus = planckian_locus();
  const auto distance = [&](int k) { return (locus[static_cast<std::size_t>(k)] - place).squaredNorm(); };
  int nearest = 0;
  for (int k = 1; k <= steps; ++k) {
    if (distance(k) < distance(nearest)) nearest = k;
  }
  if (nearest == 0 || nearest == steps || distance(nearest) > 0.05 * 0.05) return std::nullopt;
  // The least of the parabola through the squares of three distances.
  const double before = distance(nearest - 1), after = distance(nearest + 1);
  const double curvature = before - 2 * distance(nearest) + after;
  return temperature_of(nearest + (curvature > 0 ? (before - after) / (2 * curvature) : 0));
}

bool are_of_wavelengths(const Bands& bands) {
  return std::any_of(bands.begin(), bands.end(), [](const Band& band) { return band.edges_nm[1] > 0; });
}

Field xyz_rows(const FieldView& radiance, const Bands& bands) {
  Field xyz(radiance.rows(), 3);
  for (Eigen::Index row = 0; row < radiance.rows(); ++row)
    xyz.row(row) = xyz_of(radiance.row(row), bands).transpose().array();
  return xyz;
}

Eigen::VectorXd colour_temperatures(const FieldView& xyz) {
  Eigen::VectorXd kelvin(xyz.rows());
  for (Eigen::Index row = 0; row < xyz.rows(); ++row) {
    const Eigen::Vector3d colour = xyz.row(row).matrix().transpose();
    kelvin[row] = correlated_colour_temperature(colour).value_or(std::numeric_limits<double>::quiet_NaN());
  }
  return kelvin;
}

Lab lab_of(const Eigen::Vector3d& xyz, const Eigen::Vector3d& white) {
  const auto root = [](double t) {
    constexpr double edge = 6.0 / 29;
    return t > edge * edge * edge ? std::cbrt(t) : t / (3 * edge * edge) + 4.0 / 29;
  };
  const double x = root(xyz.x() / white.x()), y = root(xyz.y() / white.y()), z = root(xyz.z() / white.z());
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

double colour_difference(const Lab& a, const Lab& b) {
  // Chroma and hue with a* stretched for grays.
  const double stretch = 1 + 0.5 * (1 - seventh_share((std::hypot(a[1], a[2]) + std::hypot(b[1], b[2])) / 2));
  const double chroma_a = std::hypot(stretch * a[1], a[2]), chroma_b = std::hypot(stretch * b[1], b[2]);
  const double hue_a = hue_of(stretch * a[1], a[2]), hue_b = hue_of(stretch * b[1], b[2]);
  const bool has_grey = chroma_a * chroma_b == 0;
  const double hue = has_grey ? hue_a + hue_b : mean_hue(hue_a, hue_b);
  const double lightness = (a[0] + b[0]) / 2;
  const double chroma = (chroma_a + chroma_b) / 2;
  // Differences by their weights.
  const double t = 1 - 0.17 * std::cos(radians_of(hue - 30)) + 0.24 * std::cos(radians_of(2 * hue)) +
                   0.32 * std::cos(radians_of(3 * hue + 6)) - 0.20 * std::cos(radians_of(4 * hue - 63));
  const double from_middle = (lightness - 50) * (lightness - 50);
  const double dl = (b[0] - a[0]) / (1 + 0.015 * from_middle / std::sqrt(20 + from_middle));
  const double dc = (chroma_b - chroma_a) / (1 + 0.045 * chroma);
  const double angle = has_grey ? 0 : hue_difference(hue_a, hue_b);
  const double dh = 2 * std::sqrt(chroma_a * chroma_b) * std::sin(radians_of(angle / 2)) / (1 + 0.015 * chroma * t);
  const double from_blue = (hue - 275) / 25;
  const double turn = -2 * seventh_share(chroma) * std::sin(radians_of(60 * std::exp(-from_blue * from_blue)));
  return std::sqrt(std::max(0.0, dl * dl + dc * dc + dh * dh + turn * dc * dh));
}

}  // namespace patchlight
