#include "patchlight/light/spectrum.h"

#include "light/photometry.h"

#include <gtest/gtest.h>

namespace patchlight::bands_test {
namespace {

TEST(UsualBands, AllTogetherAreWhite) {
  for (const Eigen::Index number : {1, 2, 3, 16}) {
    double weight = 0;
    std::array<double, 3> colour{};
    for (const Band& band : usual_bands(number)) {
      weight += band.luminous_weight;
      for (std::size_t channel = 0; channel < 3; ++channel) colour[channel] += band.rgb[channel];
    }
    EXPECT_NEAR(weight, 1, 1e-15) << number;
    for (const double channel : colour) EXPECT_NEAR(channel, 1, 1e-15) << number;
  }
}

TEST(UsualBands, ThreeAreRedGreenAndBlue) {
  const Bands bands = usual_bands(3);
  EXPECT_EQ(bands[2].name, "b");
  EXPECT_EQ(usual_bands(4)[2].name, "3");
  EXPECT_EQ(bands[1].rgb, (std::array<double, 3>{0, 1, 0}));
  EXPECT_GT(bands[1].luminous_weight, bands[0].luminous_weight);
}

// 179 lm/W times the luminous part, for all bands.
TEST(Luminance, WeighsBandsAsTheyAreStated) {
  const Bands bands = {{"450 nm", 0.25, {0, 0, 1}}, {"570 nm", 0.75, {1, 1, 0}}};
  Spectrum radiance(2);
  radiance << 4, 8;
  EXPECT_EQ(luminance(radiance, bands), 179 * 7);
  EXPECT_EQ(luminance(radiance), 179 * 6);
}

}  // namespace
}  // namespace patchlight::bands_test
