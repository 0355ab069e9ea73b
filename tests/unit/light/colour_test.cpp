
#include "light/photometry.h"
#include "light/spectra.h"

#include <array>
#include <gtest/gtest.h>

namespace patchlight::colour_test {
namespace {

struct Pair {
  Lab a, b;
  double difference;
};

// Sharma, Wu and Dalal 2005, table 1: pairs that reveal errors in the hue and its mean, to four digits.
const std::array<Pair, 13> published = {{{{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
                                         {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
                                         {{50, 2.8361, -74.0200}, {50, 0, -82.7485}, 3.4412},
                                         {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1.0000},
                                         {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1.0000},
                                         {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1.0000},
                                         {{50, 0, 0}, {50, -1, 2}, 2.3669},
                                         {{50, 2.49, -0.001}, {50, -2.49, 0.0009}, 7.1792},
                                         {{50, 2.49, -0.001}, {50, -2.49, 0.0011}, 7.2195},
                                         {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
                                         {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
                                         {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
                                         {{2.0776, 0.0795, -1.1350}, {0.9033, -0.0636, -0.5514}, 0.9082}}};

TEST(ColourDifference, IsThePublishedOneBothWays) {
  for (const Pair& pair : published) {
    EXPECT_NEAR(colour_difference(pair.a, pair.b), pair.difference, 5.1e-5);
    EXPECT_NEAR(colour_difference(pair.b, pair.a), pair.difference, 5.1e-5);
  }
}

TEST(ColourDifference, OfAColourToItselfIsZero) {
  EXPECT_EQ(colour_difference({40, 20, -30}, {40, 20, -30}), 0);
  EXPECT_EQ(lab_of({95, 100, 108}, {95, 100, 108}), Lab(100, 0, 0));
}

// The parabola through squared distances at steps of 1 % has an error of the order of the step, relative to the step.
// CIE 15 gives D65 a temperature of 6504 K.
TEST(ColourTemperature, IsThatOfABlackBody) {
  for (const double kelvin : {1500.0, 2700.0, 4000.0, 6504.0, 20000.0}) {
    const auto found = correlated_colour_temperature(xyz_of_cells(in_cells(*planckian_spectrum(kelvin), Beyond::zero)));
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found / kelvin, 1, 1e-4);
  }
  const auto of_d65 = correlated_colour_temperature(xyz_of_cells(in_cells(*illuminant_d65_spectrum(), Beyond::zero)));
  EXPECT_NEAR(of_d65.value_or(0), 6504, 3);
}

TEST(ColourTemperature, HasNoMeaningFarFromBlackBodies) {
  EXPECT_FALSE(correlated_colour_temperature({0, 0, 0}));
  EXPECT_FALSE(correlated_colour_temperature({0.3, 1, 0.1}));  // green
}

TEST(Xyz, OfLinearRgbIsThatOfItsPrimaries) {
  const Bands bands = usual_bands(3);
  const Eigen::Vector3d white = xyz_of(rgb(1, 1, 1), bands) / luminous_efficacy;
  // CIE 15: D65 is 0.95047, 1, 1.08883.
  EXPECT_NEAR(white.x(), 0.95047, 5e-5);
  EXPECT_NEAR(white.y(), 1, 1e-12);
  EXPECT_NEAR(white.z(), 1.08883, 3e-4);  // that of x and y within 5e-5
  EXPECT_FALSE(are_of_wavelengths(bands));
}

}  // namespace
}  // namespace patchlight::colour_test
