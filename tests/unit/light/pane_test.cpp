#include "light/pane.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <tuple>
#include <vector>

namespace patchlight::pane_test {
namespace {

constexpr double rounding = 1e-14;

double cosine_of_degrees(double angle) { return std::cos(angle * std::numbers::pi / 180); }

// Index; transmittance at normal incidence.
class APane : public testing::TestWithParam<std::tuple<double, double>> {
 protected:
  double index() const { return std::get<0>(GetParam()); }
  double stated() const { return std::get<1>(GetParam()); }
  Pane pane() const { return pane_of(index(), stated()); }
};

TEST_P(APane, LetsThroughWhatIsStatedAtNormalIncidence) {
  EXPECT_NEAR(transmittance(pane(), 1), stated(), rounding);
  EXPECT_LE(pane().index, index() + rounding);
  EXPECT_LE(pane().internal, 1);
  EXPECT_TRUE(pane().index == index() || pane().internal == 1);
}

TEST_P(APane, SharesOutAllLightOrAbsorbsIt) {
  for (int degree = 0; degree <= 90; ++degree) {
    const double cosine = cosine_of_degrees(degree);
    const double T = transmittance(pane(), cosine);
    const double R = specular_reflectance(pane(), cosine);
    EXPECT_GE(T, 0) << degree;
    EXPECT_GE(R, 0) << degree;
    EXPECT_LE(T + R, 1 + rounding) << degree;
    if (pane().internal == 1) {
      EXPECT_NEAR(T + R, 1, rounding) << degree;
    } else if (degree < 90) {
      EXPECT_LT(T + R, 1) << degree;
    }
  }
}

TEST_P(APane, LetsLessThroughTheFlatterLightComes) {
  // For indices up to that of dense glass. Above about 2, Brewster's angle gains more than it loses.
  for (int degree = 0; degree < 90; ++degree)
    EXPECT_LE(transmittance(pane(), cosine_of_degrees(degree + 1)),
              transmittance(pane(), cosine_of_degrees(degree)) + rounding)
        << degree;
}

TEST_P(APane, IsAMirrorAtGrazingAngles) {
  if (pane().index == 1) return;
  // 1 - r of one surface approaches 4 cos theta / (n cos theta'), or n^2 times that, with cos theta'^2 = 1 - 1 / n^2.
  const double n = pane().index;
  const double cosine = 1e-9;
  const double most = 4 * n * cosine / std::sqrt(1 - 1 / (n * n));
  EXPECT_LE(transmittance(pane(), cosine), 1.01 * most);
  EXPECT_GE(specular_reflectance(pane(), cosine), 1 - 1.01 * most);
  EXPECT_EQ(transmittance(pane(), 0), 0);
  EXPECT_EQ(specular_reflectance(pane(), 0), 1);
}

INSTANTIATE_TEST_SUITE_P(Light, APane,
                         testing::Combine(testing::Values(1.0, 1.33, 1.52, 1.9),
                                          testing::Values(0.0, 1e-6, 0.2, 0.5, 0.8, 0.9, 0.95, 0.999, 1.0)));

// One surface at a time: the sum over all paths of light between them, until nothing remains.
struct Series {
  double transmitted = 0;
  double reflected = 0;
};

Series summed(double r, double a) {
  Series sum{0, r};
  double inside = (1 - r) * a;  // arrives at the far surface
  for (int k = 0; k < 400; ++k) {
    sum.transmitted += inside * (1 - r);
    inside *= r * a;  // arrives at the near surface
    sum.reflected += inside * (1 - r);
    inside *= r * a;
  }
  return sum;
}

TEST(AnyPane, IsTheSumOfAllReflectionsInside) {
  const double n = 1.52;
  const Pane pane = pane_of(n, 0.6);
  for (const double degree : {0.0, 30.0, 56.659, 75.0, 85.0}) {
    const double inward = degree * std::numbers::pi / 180;
    const double inside = std::asin(std::sin(inward) / n);
    // Fresnel's equations with sines and tangents of the angles, and their limit at normal incidence.
    const double s = degree > 0 ? std::sin(inward - inside) / std::sin(inward + inside) : (n - 1) / (n + 1);
    const double p = degree > 0 ? std::tan(inward - inside) / std::tan(inward + inside) : (n - 1) / (n + 1);
    const double a = std::pow(pane.internal, 1 / std::cos(inside));
    const Series across = summed(s * s, a);
    const Series along = summed(p * p, a);
    EXPECT_NEAR(transmittance(pane, std::cos(inward)), (across.transmitted + along.transmitted) / 2, 1e-13);
    EXPECT_NEAR(specular_reflectance(pane, std::cos(inward)), (across.reflected + along.reflected) / 2, 1e-13);
  }
}

TEST(AClearPane, HasTheReflectanceOfTwoSurfaces) {
  // A pane of this index reflects at least 2 r / (1 + r), with r = ((n - 1) / (n + 1))^2, and transmits at most the
  // rest.
  const double r = std::pow(0.52 / 2.52, 2);
  const Pane pane = pane_of(1.52, (1 - r) / (1 + r));
  EXPECT_NEAR(pane.index, 1.52, rounding);
  EXPECT_EQ(pane.internal, 1);
  EXPECT_NEAR(specular_reflectance(pane, 1), 2 * r / (1 + r), rounding);
}

TEST(AClearPane, LetsAllLightOfOnePolarisationThroughAtBrewstersAngle) {
  // tan theta = n, where r_p = 0 and r_s = ((n^2 - 1) / (n^2 + 1))^2.
  const double n = 1.5;
  const double r0 = std::pow((n - 1) / (n + 1), 2);
  const Pane pane = pane_of(n, (1 - r0) / (1 + r0));
  const double r = std::pow((n * n - 1) / (n * n + 1), 2);
  EXPECT_NEAR(transmittance(pane, 1 / std::sqrt(1 + n * n)), (1 + (1 - r) / (1 + r)) / 2, rounding);
}

TEST(APaneOfTransmittanceOne, IsNone) {
  for (const double index : {1.0, 1.52, 3.0}) {
    const Pane pane = pane_of(index, 1);
    for (const double cosine : {1.0, 0.5, 1e-3, 0.0}) {
      EXPECT_EQ(transmittance(pane, cosine), 1);
      EXPECT_EQ(specular_reflectance(pane, cosine), 0);
    }
  }
}

TEST(APaneOfIndexOne, IsASheetWithHoles) {
  // The open fraction of a sheet without thickness is the same from all directions.
  const Pane pane = pane_of(1, 0.7);
  for (const double cosine : {1.0, 0.5, 0.1, 0.0}) {
    EXPECT_EQ(transmittance(pane, cosine), 0.7);
    EXPECT_EQ(specular_reflectance(pane, cosine), 0);
  }
}

TEST(APaneOfTransmittanceNought, LetsNothingThroughAndMirrorsAsOneSurface) {
  const Pane pane = pane_of(1.52, 0);
  for (const double cosine : {1.0, 0.5, 0.0}) EXPECT_EQ(transmittance(pane, cosine), 0);
  EXPECT_NEAR(specular_reflectance(pane, 1), std::pow(0.52 / 2.52, 2), rounding);
}

}  // namespace
}  // namespace patchlight::pane_test
