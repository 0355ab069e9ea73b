#include "render/hemisphere.h"

#include "render/pixel_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patchlight {

Hemisphere::Hemisphere(int rays, const Vector& normal)
    : rings_(std::max(1, static_cast<int>(std::lround(std::sqrt(rays / std::numbers::pi))))),
      sectors_(std::max(3, static_cast<int>(std::lround(static_cast<double>(rays) / rings_)))),
      normal_(normal),
      first_(normal.unitOrthogonal()),
      second_(normal.cross(first_)) {}

std::size_t Hemisphere::cell(int ring, int sector) const {
  const int around = (sector + sectors_) % sectors_;
  return static_cast<std::size_t>(ring) * static_cast<std::size_t>(sectors_) + static_cast<std::size_t>(around);
}

double Hemisphere::sine(int ring) const { return std::sqrt(static_cast<double>(ring) / rings_); }

std::vector<Vector> Hemisphere::directions(std::uint32_t seed) const {
  std::vector<Vector> all;
  for (int j = 0; j < rings_; ++j) {
    for (int k = 0; k < sectors_; ++k) {
      const auto u = pixel_sample(static_cast<std::uint32_t>(cell(j, k)), seed);
      const double square = (j + u[0]) / rings_;  // sin^2
      const double angle = 2 * std::numbers::pi * (k + u[1]) / sectors_;
      const double sine_here = std::sqrt(square);
      all.push_back(sine_here * (std::cos(angle) * first_ + std::sin(angle) * second_) +
                    std::sqrt(1 - square) * normal_);
    }
  }
  return all;
}

HemisphereIrradiance Hemisphere::irradiance(const FieldView& radiosity, std::span<const double> distances) const {
  const Eigen::Index bands = radiosity.cols();
  const auto row = [&](int j, int k) { return radiosity.row(static_cast<Eigen::Index>(cell(j, k))); };
  const auto nearer = [&](int j, int k, int jj, int kk) {
    return std::min(distances[cell(j, k)], distances[cell(jj, kk)]);
  };
  HemisphereIrradiance found{radiosity.colwise().mean(), Spectrum::Zero(bands), Field::Zero(3, bands)};
  for (int k = 0; k < sectors_; ++k) {
    const double middle = 2 * std::numbers::pi * (k + 0.5) / sectors_;
    const double edge = 2 * std::numbers::pi * k / sectors_;
    const Vector outward = std::cos(middle) * first_ + std::sin(middle) * second_;
    const Vector along = -std::sin(edge) * first_ + std::cos(edge) * second_;
    Spectrum by_rings = Spectrum::Zero(bands);
    Spectrum by_sectors = Spectrum::Zero(bands);
    for (int j = 0; j < rings_; ++j) {
      // With L = B / pi
      if (j > 0) {
        const double square = sine(j) * sine(j);
        const double factor = 2 * std::numbers::pi / sectors_ * sine(j) * (1 - square) / nearer(j, k, j - 1, k);
        by_rings += factor / std::numbers::pi * (row(j, k) - row(j - 1, k));
      }
      const double width = (sine(j + 1) - sine(j)) / nearer(j, k, j, k - 1);
      by_sectors += width / std::numbers::pi * (row(j, k) - row(j, k - 1));
      // Two neighbours differ by twice the variance within a cell, and by what the light changes from one to the other.
      found.variance += (row(j, k) - row(j, k - 1)).square() / 2;
    }
    found.gradient += (outward * by_rings.matrix() + along * by_sectors.matrix()).array();
  }
  const double count = static_cast<double>(rings_) * sectors_;
  found.variance /= count * count;
  return found;
}

double Hemisphere::harmonic_mean(std::span<const double> distances) const {
  double sum = 0;
  for (const double distance : distances) sum += 1 / distance;
  return static_cast<double>(distances.size()) / sum;
}

}  // namespace patchlight
