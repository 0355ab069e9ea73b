#include "render/final_gather.h"

#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <vector>

namespace patchlight::pixel_statistics_test {
namespace {

PixelSamples pixel(std::initializer_list<double> luminances) {
  PixelSamples samples;
  samples.extend(static_cast<std::uint32_t>(luminances.size()));
  for (const double luminance : luminances) samples.add(luminance);
  return samples;
}

TEST(PixelStatistics, OfEqualPixelsAreThoseOfEach) {
  // Quarters 1, 3, 1, 3 about their mean 2: a variance of 4 / 3 of one sample, and a fourth of it for the mean.
  const std::vector<PixelSamples> pixels(6, pixel({1, 3, 1, 3}));
  const Eigen::VectorXd variances = pooled_variances(pixels, 3);
  for (Eigen::Index k = 0; k < 6; ++k) EXPECT_NEAR(variances[k], 1.0 / 3, 1e-15);
  EXPECT_NEAR(mean_relative_error(pixels, variances.cwiseSqrt()), std::sqrt(1.0 / 3) / 2, 1e-15);
}

// The rim of a lamp, of luminance 0 or 100, beside a wall of luminance 1 without noise. The wall gets half of the rim's
// relative variance. Half of its absolute variance would be a standard error of 2,000 % of the wall.
TEST(PixelStatistics, BesideARimGrowByItsRelativeVariance) {
  const std::vector<PixelSamples> pixels = {pixel({1, 1, 1, 1}), pixel({100, 0, 100, 0})};
  const Eigen::VectorXd variances = pooled_variances(pixels, 2);
  const double of_rim = 4 * 50 * 50 / 12.0 / (50 * 50);  // of its mean, relative
  EXPECT_NEAR(variances[0], of_rim / 2, 1e-12);
  EXPECT_NEAR(variances[1], of_rim / 2 * 50 * 50, 1e-9);
}

TEST(PixelStatistics, GrowWithTheSquareOfTheLuminance) {
  const std::vector<PixelSamples> one = {pixel({1, 2, 3, 5}), pixel({2, 2, 2, 1}), pixel({9, 7, 9, 1})};
  const std::vector<PixelSamples> twice = {pixel({2, 4, 6, 10}), pixel({4, 4, 4, 2}), pixel({18, 14, 18, 2})};
  EXPECT_TRUE(pooled_variances(twice, 3).isApprox(4 * pooled_variances(one, 3), 1e-14));
  EXPECT_EQ(wanted_samples(one, 3, 0.05, 256), wanted_samples(twice, 3, 0.05, 256));
}

TEST(PixelStatistics, OfADarkPictureAreZero) {
  const std::vector<PixelSamples> pixels(4, pixel({0, 0, 0, 0}));
  EXPECT_EQ(pooled_variances(pixels, 2).maxCoeff(), 0);
  EXPECT_EQ(mean_relative_error(pixels, Eigen::VectorXd::Zero(4)), 0);
  EXPECT_EQ(wanted_samples(pixels, 2, 0.01, 64), std::vector<std::uint32_t>(4, 4));
}

}  // namespace
}  // namespace patchlight::pixel_statistics_test
