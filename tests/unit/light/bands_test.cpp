#include "light/bands.h"

#include <gtest/gtest.h>

namespace patchlight::bands_test {
namespace {

TEST(Bands, AllTogetherAreWhite) {
  for (const Eigen::Index number : {1, 2, 3, 16}) {
    const Bands bands{number};
    double weight = 0;
    std::array<double, 3> colour{};
    for (Eigen::Index band = 0; band < number; ++band) {
      weight += bands.luminous_weight(band);
      for (std::size_t channel = 0; channel < 3; ++channel) colour[channel] += bands.rgb(band)[channel];
    }
    EXPECT_NEAR(weight, 1, 1e-15) << number;
    for (const double channel : colour) EXPECT_NEAR(channel, 1, 1e-15) << number;
  }
}

TEST(Bands, ThreeAreRedGreenAndBlue) {
  EXPECT_EQ(Bands{3}.name(2), "b");
  EXPECT_EQ(Bands{4}.name(2), "3");
  EXPECT_EQ(Bands{3}.rgb(1), (std::array<double, 3>{0, 1, 0}));
  EXPECT_GT(Bands{3}.luminous_weight(1), Bands{3}.luminous_weight(0));
}

}  // namespace
}  // namespace patchlight::bands_test
