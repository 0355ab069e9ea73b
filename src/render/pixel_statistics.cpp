#include "render/pixel_statistics.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace patchlight {
namespace {

// What is shown as dark as this share of the luminance of bright_share of the pixels may have that much's error.
constexpr double dark = 0.05;
constexpr double bright_share = 0.9;

double least_luminance(const std::vector<PixelSamples>& pixels) {
  std::vector<double> values;
  for (const PixelSamples& pixel : pixels) {
    if (pixel.mean() > 0) values.push_back(pixel.mean());
  }
  if (values.empty()) return 0;
  const auto bright =
      values.begin() + static_cast<std::ptrdiff_t>(bright_share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), bright, values.end());
  return dark * *bright;
}

}  // namespace

void PixelSamples::extend(std::uint32_t count) {
  assert(std::has_single_bit(count) && count >= room_);
  for (; room_ < count; room_ *= 2) quarters_ = {quarters_[0] + quarters_[1], quarters_[2] + quarters_[3], 0, 0};
}

void PixelSamples::add(double luminance) {
  assert(count_ < room_);
  quarters_[count_ / (room_ / 4)] += luminance;
  ++count_;
}

double PixelSamples::mean() const {
  return (quarters_[0] + quarters_[1] + quarters_[2] + quarters_[3]) / std::max(1U, count_);
}

double PixelSamples::variance() const {
  assert(count_ == room_);
  const double size = room_ / 4.0;
  double sum = 0;
  for (const double quarter : quarters_) sum += std::pow(quarter / size - mean(), 2);
  // Of the mean of a quarter sum / 3, of that of all a fourth of it
  return sum / 12 * count_;
}

Eigen::VectorXd reference_luminances(const std::vector<PixelSamples>& pixels) {
  const double least = least_luminance(pixels);
  Eigen::VectorXd references(static_cast<Eigen::Index>(pixels.size()));
  for (std::size_t k = 0; k < pixels.size(); ++k)
    references[static_cast<Eigen::Index>(k)] = std::max(least, pixels[k].mean());
  return references;
}

Eigen::VectorXd pooled_variances(const std::vector<PixelSamples>& pixels, int width) {
  const int height = static_cast<int>(pixels.size()) / width;
  const auto index = [&](int x, int y) { return static_cast<Eigen::Index>(y) * width + x; };
  const Eigen::VectorXd references = reference_luminances(pixels);
  Eigen::VectorXd own = Eigen::VectorXd::Zero(references.size());
  for (Eigen::Index k = 0; k < own.size(); ++k) {
    if (references[k] > 0) own[k] = pixels[static_cast<std::size_t>(k)].variance() / (references[k] * references[k]);
  }
  Eigen::VectorXd pooled(own.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      int number = 0;
      for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u, ++number) sum += own[index(u, v)];
      const Eigen::Index at = index(x, y);
      pooled[at] = sum / number * references[at] * references[at] / pixels[static_cast<std::size_t>(at)].count();
    }
  }
  return pooled;
}

double mean_relative_error(const std::vector<PixelSamples>& pixels, const Eigen::VectorXd& errors) {
  const Eigen::VectorXd references = reference_luminances(pixels);
  if (!(references.array() > 0).all()) return 0;
  return std::sqrt((errors.array() / references.array()).square().mean());
}

std::vector<std::uint32_t> wanted_samples(const std::vector<PixelSamples>& pixels, int width, double error,
                                          std::uint32_t most) {
  const Eigen::VectorXd variances = pooled_variances(pixels, width);
  const Eigen::VectorXd references = reference_luminances(pixels);
  std::vector<std::uint32_t> wanted;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const double allowed = error * references[static_cast<Eigen::Index>(k)];
    const double variance = variances[static_cast<Eigen::Index>(k)];
    const std::uint32_t count = pixels[k].count();
    const double times = variance > 0 ? variance / (allowed * allowed) : 0;
    // In inverse proportion to their number
    wanted.push_back(!(times > 1) || count >= most
                         ? count
                         : std::bit_ceil(static_cast<std::uint32_t>(std::min<double>(most, std::ceil(times * count)))));
  }
  return wanted;
}

}  // namespace patchlight
