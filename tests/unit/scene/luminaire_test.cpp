#include "patchlight/scene/luminaire.h"

#include "scene/photometric_web.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::luminaire_test {
namespace {

constexpr double pi = std::numbers::pi;

const LuminaireFrame down{-Vector::UnitZ(), Vector::UnitX()};

// A direction at angle `vertical` from the nadir, rotated by `horizontal` from x towards y, in degrees.
Vector from_nadir(double vertical, double horizontal) {
  const double v = vertical * pi / 180;
  const double h = horizontal * pi / 180;
  return {std::sin(v) * std::cos(h), std::sin(v) * std::sin(h), -std::cos(v)};
}

// The table is 100 h + v, so each value identifies its direction.
PhotometricWeb telling(PhotometricType type, std::vector<double> vertical, std::vector<double> horizontal) {
  PhotometricWeb web;
  web.type = type;
  for (const double h : horizontal) {
    for (const double v : vertical) web.candela.push_back(100 * h + v);
  }
  web.vertical = std::move(vertical);
  web.horizontal = std::move(horizontal);
  return web;
}

TEST(Candela, IsBilinearInTheAngles) {
  const PhotometricWeb web = telling(PhotometricType::c, {0, 45, 180}, {0, 90, 360});
  for (const double v : {10.0, 45.0, 100.0, 170.0}) {
    for (const double h : {5.0, 90.0, 200.0, 359.0})
      EXPECT_NEAR(candela(web, down, from_nadir(v, h)), 100 * h + v, 1e-8);
  }
}

TEST(Candela, FollowsTheSymmetryOfTypeC) {
  const PhotometricWeb quadrant = telling(PhotometricType::c, {0, 90}, {0, 45, 90});
  for (const double h : {30.0, 150.0, 210.0, 330.0})
    EXPECT_NEAR(candela(quadrant, down, from_nadir(20, h)), 3020, 1e-8) << h;
  const PhotometricWeb half = telling(PhotometricType::c, {0, 90}, {0, 90, 180});
  EXPECT_NEAR(candela(half, down, from_nadir(20, 330)), 3020, 1e-8);
  EXPECT_NEAR(candela(half, down, from_nadir(20, 210)), 15020, 1e-8);
  const PhotometricWeb about_quarter = telling(PhotometricType::c, {0, 90}, {90, 180, 270});
  EXPECT_NEAR(candela(about_quarter, down, from_nadir(20, 100)), 10020, 1e-8);
  EXPECT_NEAR(candela(about_quarter, down, from_nadir(20, 80)), 10020, 1e-8);
  EXPECT_NEAR(candela(about_quarter, down, from_nadir(20, 280)), 26020, 1e-8);
  const PhotometricWeb round = telling(PhotometricType::c, {0, 90}, {0});
  EXPECT_NEAR(candela(round, down, from_nadir(20, 123)), 20, 1e-8);
}

TEST(Candela, IsZeroBeyondTheTable) {
  const PhotometricWeb web = telling(PhotometricType::c, {0, 90}, {0});
  EXPECT_EQ(candela(web, down, from_nadir(91, 0)), 0);
  EXPECT_NEAR(candela(web, down, from_nadir(89, 0)), 89, 1e-8);
}

TEST(Candela, OfTypesAAndBGoesUpAndToTheSide) {
  // Aimed at y with its top at z, so its right is x. 30 degrees to the right on the equator is the same for both. For a
  // direction to the right and up the angles differ: atan and asin are exchanged.
  const LuminaireFrame ahead{Vector::UnitY(), Vector::UnitZ()};
  const PhotometricWeb a = telling(PhotometricType::a, {-90, 90}, {-90, 90});
  const PhotometricWeb b = telling(PhotometricType::b, {-90, 90}, {-90, 90});
  const Vector right(std::sin(pi / 6), std::cos(pi / 6), 0);
  EXPECT_NEAR(candela(a, ahead, right), 3000, 1e-8);
  EXPECT_NEAR(candela(b, ahead, right), 3000, 1e-8);
  const Vector both = Vector(1, 1, 1).normalized();
  const double corner = std::asin(1 / std::sqrt(3.0)) * 180 / pi;
  EXPECT_NEAR(candela(a, ahead, both), 4500 + corner, 1e-8);
  EXPECT_NEAR(candela(b, ahead, both), 100 * corner + 45, 1e-8);
  // From 0: left and right are symmetric.
  const PhotometricWeb symmetric = telling(PhotometricType::b, {-90, 90}, {0, 90});
  EXPECT_NEAR(candela(symmetric, ahead, Vector(-right.x(), right.y(), 0)), 3000, 1e-8);
}

TEST(LuminousFlux, OfIntensitiesWithAClosedForm) {
  // 1 cd in all directions: 4 pi lm, for any symmetry. The midpoint rule has a relative error of (half a degree)^2 / 24
  // = 3e-6.
  for (const auto& horizontal : {std::vector<double>{0}, {0, 90}, {0, 180}, {0, 360}}) {
    PhotometricWeb web = telling(PhotometricType::c, {0, 180}, horizontal);
    web.candela.assign(web.candela.size(), 1);
    EXPECT_NEAR(luminous_flux(web), 4 * pi, 1e-4);
  }
  // cos v below, in a table of 1 degree: pi lm. Chords are too low by a fraction (1 degree)^2 / 12 = 2.5e-5.
  PhotometricWeb lambert;
  lambert.horizontal = {0};
  for (int v = 0; v <= 90; ++v) {
    lambert.vertical.push_back(v);
    lambert.candela.push_back(std::cos(v * pi / 180));
  }
  EXPECT_NEAR(luminous_flux(lambert), pi, 2e-4);
}

TEST(TiltFactor, IsLinearBetweenItsAngles) {
  PhotometricWeb web;
  EXPECT_EQ(tilt_factor(web, 33), 1);
  web.tilt = {0, 90};
  web.tilt_factor = {1, 0.8};
  EXPECT_NEAR(tilt_factor(web, 45), 0.9, 1e-12);
  EXPECT_NEAR(tilt_factor(web, 120), 0.8, 1e-12);
}

TEST(SpotProfile, IsAHalfAtTheBeamAndATenthAtTheField) {
  const SpotLight spot{Spectrum::Ones(1), 15, 25};
  EXPECT_EQ(spot_profile(spot, 1), 1);
  EXPECT_NEAR(spot_profile(spot, std::cos(15 * pi / 180)), 0.5, 1e-12);
  EXPECT_NEAR(spot_profile(spot, std::cos(25 * pi / 180)), 0.1, 1e-12);
}

TEST(SpotSolidAngle, OfANarrowGaussianBeam) {
  // 2^-(a / b)^2 integrates to pi b^2 / ln 2 in the plane. On the sphere a ring has the width sin a = a - a^3 / 6, so
  // the integral is lower by the fraction b^2 / (6 ln 2), with b = 0.0175 and without higher terms.
  const double field = std::sqrt(std::log2(10.0));
  const double b = pi / 180;
  const double expected = pi * b * b / std::log(2.0) * (1 - b * b / (6 * std::log(2.0)));
  EXPECT_NEAR(spot_solid_angle({Spectrum::Ones(1), 1, field}), expected, 1e-6 * expected);
}

}  // namespace
}  // namespace patchlight::luminaire_test
