#include "render/tone_map.h"

#include "light/photometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

constexpr double percentile_value = 0.7;  // of white: shows the 90th percentile of the luminances above 0
constexpr double shoulder = 0.8;          // luminances above this share of white are compressed

// Luminance in units in which a gray radiance of 1 has luminance 1.
double display_luminance(const Spectrum& radiance, const Bands& bands) {
  return luminance(radiance, bands) / luminous_efficacy;
}

// The identity up to the shoulder, from there an exponential with the same slope that tends to 1.
double roll_off(double value) {
  if (value <= shoulder) return value;
  return 1 - (1 - shoulder) * std::exp(-(value - shoulder) / (1 - shoulder));
}

// IEC 61966-2-1:1999, section 5.2: linear to non-linear sRGB, in eight bits.
std::uint8_t srgb(double linear) {
  const double value = linear > 0 ? std::min(linear, 1.0) : 0.0;  // not-a-number becomes black
  const double encoded = value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

}  // namespace

std::array<double, 3> linear_rgb(const Spectrum& radiance, const Bands& bands) {
  std::array<double, 3> sum{};
  for (std::size_t band = 0; band < bands.size(); ++band) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      sum[channel] += bands[band].rgb[channel] * radiance[static_cast<Eigen::Index>(band)];
  }
  return sum;
}

double exposure_for(const FieldView& radiance, const Eigen::VectorXd& weight, const Bands& bands) {
  std::vector<std::pair<double, double>> luminances;  // with their weights
  for (Eigen::Index row = 0; row < radiance.rows(); ++row) {
    const double value = display_luminance(radiance.row(row), bands);
    if (value > 0 && std::isfinite(value) && weight[row] > 0) luminances.emplace_back(value, weight[row]);
  }
  if (luminances.empty()) return 1;
  std::sort(luminances.begin(), luminances.end());

  double total = 0;
  for (const auto& [value, share] : luminances) total += share;
  double below = 0;
  for (const auto& [value, share] : luminances) {
    below += share;
    if (below >= 0.9 * total) return percentile_value / value;
  }
  return percentile_value / luminances.back().first;
}

std::vector<std::array<std::uint8_t, 3>> tone_map(const FieldView& radiance, double exposure, const Bands& bands) {
  std::vector<std::array<std::uint8_t, 3>> colours(static_cast<std::size_t>(radiance.rows()));
  for (Eigen::Index row = 0; row < radiance.rows(); ++row) {
    const Spectrum exposed = exposure * radiance.row(row);
    const double value = display_luminance(exposed, bands);
    // One factor for all channels keeps the hue.
    const double scale = value > 0 ? roll_off(value) / value : 0;
    const std::array<double, 3> linear = linear_rgb(exposed, bands);
    auto& colour = colours[static_cast<std::size_t>(row)];
    for (std::size_t channel = 0; channel < 3; ++channel) colour[channel] = srgb(scale * linear[channel]);
  }
  return colours;
}

std::vector<std::array<std::uint8_t, 3>> false_color(const Eigen::VectorXd& values, double lower, double upper) {
  // sRGB at equal steps: blue, cyan, green, yellow, red.
  constexpr std::array<std::array<double, 3>, 5> stops = {
      {{25, 40, 190}, {0, 165, 215}, {40, 190, 60}, {250, 225, 40}, {215, 25, 25}}};
  std::vector<std::array<std::uint8_t, 3>> colours;
  colours.reserve(static_cast<std::size_t>(values.size()));
  for (const double value : values) {
    const double ratio = (value - lower) / (upper - lower);
    const double position = ratio > 0 ? 4 * std::min(ratio, 1.0) : 0.0;
    const auto stop = std::min(static_cast<std::size_t>(position), std::size_t{3});
    const double part = position - static_cast<double>(stop);
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
      colour[c] = static_cast<std::uint8_t>(std::lround((1 - part) * stops[stop][c] + part * stops[stop + 1][c]));
    }
    colours.push_back(colour);
  }
  return colours;
}

double quantile(std::vector<double> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

bool is_lit(const FieldView& radiance, const Eigen::VectorXd& weight) {
  return ((radiance.rowwise().maxCoeff() > 0) && (weight.array() > 0)).any();
}

Eigen::VectorXd box_means(const Eigen::VectorXd& values, int width, int reach) {
  const int height = static_cast<int>(values.size()) / width;
  Eigen::VectorXd means(values.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0;
      int count = 0;
      for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u, ++count)
          sum += values[static_cast<Eigen::Index>(v) * width + u];
      means[static_cast<Eigen::Index>(y) * width + x] = sum / count;
    }
  }
  return means;
}

DisplayImage with_isolines(DisplayImage image, const Eigen::VectorXd& values, const std::vector<double>& levels) {
  const auto index = [&](int x, int y) { return static_cast<Eigen::Index>(y) * image.width + x; };
  const Eigen::VectorXd smooth = box_means(values, image.width, 2);
  const auto level_of = [&](double value) { return std::upper_bound(levels.begin(), levels.end(), value); };
  const auto crosses = [&](Eigen::Index a, Eigen::Index b) {
    const double lower = std::min(smooth[a], smooth[b]), upper = std::max(smooth[a], smooth[b]);
    return upper < 4.0 / 3 * lower && level_of(lower) != level_of(upper);
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const bool is_on = (x + 1 < image.width && crosses(index(x, y), index(x + 1, y))) ||
                         (y + 1 < image.height && crosses(index(x, y), index(x, y + 1)));
      if (is_on) image.pixels[static_cast<std::size_t>(index(x, y))] = {0, 0, 0};
    }
  }
  return image;
}

}  // namespace patchlight
