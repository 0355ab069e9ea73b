#include "render/tone_map.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace patchlight::tone_map_test {
namespace {

// The usual bands without metadata.
auto tone_map(const Field& radiance, double exposure) {
  return patchlight::tone_map(radiance, exposure, usual_bands(radiance.cols()));
}

double exposure_for(const Field& radiance, const Eigen::VectorXd& weight) {
  return patchlight::exposure_for(radiance, weight, usual_bands(radiance.cols()));
}

Field grey(const Eigen::ArrayXd& values) { return values.replicate(1, 3); }

// IEC 61966-2-1: 255 (1.055 v^(1/2.4) - 0.055), below 0.0031308 255 * 12.92 v. Computed by hand:
// 0.001 -> 3.29, 0.0031308 -> 10.31, 0.18 -> 117.6, 0.5 -> 187.5(16), 0.8 -> 230.9.
TEST(ToneMap, EncodesSrgbBelowTheShoulder) {
  Eigen::ArrayXd values(6);
  values << 0, 0.001, 0.0031308, 0.18, 0.5, 0.8;
  const auto colours = tone_map(grey(values), 1);
  const std::array<int, 6> expected = {0, 3, 10, 118, 188, 231};
  for (std::size_t k = 0; k < expected.size(); ++k) {
    for (const std::uint8_t channel : colours[k]) EXPECT_EQ(channel, expected[k]);
  }
}

TEST(ToneMap, IsMonotoneAndEndsAtWhite) {
  Eigen::ArrayXd values(2001);
  for (Eigen::Index k = 0; k < values.size(); ++k) values[k] = 1e-4 * std::pow(1.01, static_cast<double>(k));  // to 4e4
  const auto colours = tone_map(grey(values), 1);
  EXPECT_TRUE(std::is_sorted(colours.begin(), colours.end()));
  EXPECT_EQ(colours.back()[0], 255);
}

// White is approached gradually: values above the display's white are still distinct.
TEST(ToneMap, RollsHighlightsOff) {
  const auto colours = tone_map(grey(Eigen::ArrayXd::LinSpaced(4, 0.7, 1.3)), 1);
  for (std::size_t k = 0; k + 1 < colours.size(); ++k) EXPECT_LT(colours[k][0], colours[k + 1][0]);
  EXPECT_LT(colours.back()[0], 255);
}

double linear(std::uint8_t channel) { return std::pow((channel / 255.0 + 0.055) / 1.055, 2.4); }

TEST(ToneMap, KeepsTheHueOfHighlights) {
  Field radiance(1, 3);
  radiance << 1, 1.2, 1.1;
  const auto [r, g, b] = tone_map(radiance, 1)[0];
  // Half a step of 255 near white is 0.0045 in linear light.
  EXPECT_NEAR(linear(r) / linear(g), 1 / 1.2, 0.01);
  EXPECT_NEAR(linear(b) / linear(g), 1.1 / 1.2, 0.01);
}

TEST(ToneMap, ShowsOtherBandNumbersAsGrey) {
  Field radiance(1, 2);
  radiance << 0.25, 0.75;  // mean 0.5
  EXPECT_EQ(tone_map(radiance, 1)[0], (std::array<std::uint8_t, 3>{188, 188, 188}));
  EXPECT_EQ(tone_map(Field::Constant(1, 1, 0.25), 2)[0], (std::array<std::uint8_t, 3>{188, 188, 188}));
}

// All luminances are below the shoulder, so 0.5 gives 188 in the channels of its band.
TEST(ToneMap, ShowsBandsAsTheSceneSays) {
  const Bands bands = {{"450 nm", 0.2, {0, 0, 1}}, {"570 nm", 0.8, {1, 1, 0}}};
  const auto shown = [&](double blue, double yellow) {
    Field radiance(1, 2);
    radiance << blue, yellow;
    return patchlight::tone_map(radiance, 1, bands)[0];
  };
  EXPECT_EQ(shown(0.5, 0), (std::array<std::uint8_t, 3>{0, 0, 188}));
  EXPECT_EQ(shown(0, 0.5), (std::array<std::uint8_t, 3>{188, 188, 0}));
  EXPECT_EQ(shown(0.5, 0.5), (std::array<std::uint8_t, 3>{188, 188, 188}));
}

TEST(ToneMap, ShowsNonsenseAsBlack) {
  Field radiance(2, 3);
  radiance << -1, -1, -1, std::numeric_limits<double>::quiet_NaN(), 0, 0;
  for (const auto& colour : tone_map(radiance, 1)) EXPECT_EQ(colour, (std::array<std::uint8_t, 3>{0, 0, 0}));
}

Field some_radiance() {
  Field radiance(100, 3);
  for (int k = 0; k < 100; ++k) radiance.row(k) << 0.01 * k, 0.3 + 0.02 * k, 0.1 / (k + 1.0);
  return radiance;
}

// Radiance k L needs exposure e / k and gives the same image; to the bit, because k is a power of two.
TEST(ExposureFor, UndoesTheScaleOfTheRadiance) {
  const Field radiance = some_radiance();
  const Eigen::VectorXd weight = Eigen::VectorXd::LinSpaced(100, 1, 2);
  const double exposure = exposure_for(radiance, weight);
  const Field scaled = 1024 * radiance;
  EXPECT_EQ(exposure_for(scaled, weight), exposure / 1024);
  EXPECT_EQ(tone_map(scaled, exposure / 1024), tone_map(radiance, exposure));
}

// Nine tenths of the weight has luminance 2, one tenth 100. The value 2 gives 0.7 of white, sRGB 218.
TEST(ExposureFor, ShowsTheNinetiethPercentileAtSevenTenths) {
  Eigen::ArrayXd values(3);
  values << 100, 2, 0;
  const double exposure = exposure_for(grey(values), Eigen::Vector3d(1, 9, 1000));
  EXPECT_NEAR(exposure, 0.35, 1e-15);
  EXPECT_EQ(tone_map(grey(values), exposure)[1][0], 218);  // 255 (1.055 0.7^(1/2.4) - 0.055) = 217.8
  // With slightly less weight there, the percentile is the bright one.
  EXPECT_NEAR(exposure_for(grey(values), Eigen::Vector3d(1, 8, 1000)), 0.007, 1e-15);
}

TEST(ExposureFor, IsOneInTheDark) {
  EXPECT_EQ(exposure_for(Field::Zero(4, 3), Eigen::VectorXd::Ones(4)), 1);
  EXPECT_EQ(exposure_for(Field::Zero(0, 3), Eigen::VectorXd()), 1);
}

// Hue in degrees of a saturated color, HSV.
double hue(const std::array<std::uint8_t, 3>& colour) {
  const double r = colour[0], g = colour[1], b = colour[2];
  const double low = std::min({r, g, b}), range = std::max({r, g, b}) - low;
  if (b == range + low) return 240 + 60 * (r - g) / range;
  if (g == range + low) return 120 + 60 * (b - r) / range;
  return 60 * (g - b) / range;
}

TEST(FalseColor, GoesFromBlueToRedWithoutTurningBack) {
  const auto colours = false_color(Eigen::VectorXd::LinSpaced(101, 10, 20), 10, 20);
  EXPECT_NEAR(hue(colours[0]), 240, 20);
  EXPECT_NEAR(hue(colours[50]), 120, 20);
  EXPECT_NEAR(hue(colours[75]), 60, 20);
  EXPECT_NEAR(hue(colours[100]), 0, 20);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_GE(hue(colours[k]) + 1, hue(colours[k + 1]));  // one degree for the rounding to eight bits
    // Smooth: no step above 4 % of the largest distance between two stops.
    for (std::size_t c = 0; c < 3; ++c) EXPECT_LE(std::abs(colours[k][c] - colours[k + 1][c]), 10);
  }
}

TEST(FalseColor, ClampsWhatIsOutside) {
  const Eigen::Vector4d values(-5, 0, 1, 7);
  const auto colours = false_color(values, 0, 1);
  EXPECT_EQ(colours[0], colours[1]);
  EXPECT_EQ(colours[2], colours[3]);
  EXPECT_EQ(false_color(values, 1, 1).size(), 4U);
}

}  // namespace
}  // namespace patchlight::tone_map_test
