#include "views/glare.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace patchlight::glare_test {
namespace {

// A direction at sigma degrees from the line of sight along y, in a plane tau degrees from the vertical.
Vector toward(double sigma, double tau) {
  const double s = sigma * std::numbers::pi / 180, t = tau * std::numbers::pi / 180;
  return {std::sin(s) * std::sin(t), std::cos(s), std::sin(s) * std::cos(t)};
}

TEST(PositionIndex, IsOneAheadAndTheSameAtBothSides) {
  EXPECT_EQ(position_index(Vector::UnitY(), Vector::UnitY(), Vector::UnitZ()), 1);
  EXPECT_NEAR(position_index(toward(30, 40), Vector::UnitY(), Vector::UnitZ()),
              position_index(toward(30, -40), Vector::UnitY(), Vector::UnitZ()), 1e-12);
}

TEST(PositionIndex, HasTheValuesOfItsFormula) {
  // Straight above (tau = 0), by hand: exp((35.2 - 1.22) 1e-3 sigma + 21e-5 sigma^2). At 30 degrees: exp(1.0194 +
  // 0.189).
  EXPECT_NEAR(position_index(toward(30, 0), Vector::UnitY(), Vector::UnitZ()), std::exp(1.0194 + 0.189), 1e-9);
  // Beside the line of sight (tau = 90): (35.2 - 28.7001 - 1.22 e^-20) 1e-3 = 6.4999e-3, and (21 + 24.0003 - 24.0003)
  // 1e-5 = 21e-5. At 20 degrees: exp(0.129998 + 0.084).
  EXPECT_NEAR(position_index(toward(20, 90), Vector::UnitY(), Vector::UnitZ()), std::exp(0.129998 + 0.084), 1e-5);
  // The tables of CIE 117 by H / R and T / R: at H / R = 1, T / R = 0 the index is 7.0 to two digits of Guth's data.
  EXPECT_NEAR(position_index(toward(45, 0), Vector::UnitY(), Vector::UnitZ()), 7.0, 0.25);
}

TEST(ProjectedOpening, IsTheShadowOfItsShape) {
  // Aim down, length 2 along x, width 1 along y, height 0.5.
  const LuminaireFrame frame{-Vector::UnitZ(), Vector::UnitX()};
  PhotometricWeb web;
  web.opening = Vector(1, 2, 0.5);
  const Vector slanted = Vector(1, 2, -2) / 3;
  EXPECT_NEAR(projected_opening(web, frame, -Vector::UnitZ()), 2, 1e-12);
  EXPECT_NEAR(projected_opening(web, frame, Vector::UnitX()), 0.5, 1e-12);
  EXPECT_NEAR(projected_opening(web, frame, Vector::UnitY()), 1, 1e-12);
  EXPECT_NEAR(projected_opening(web, frame, slanted), 2 * 2 / 3.0 + 0.5 / 3 + 1 * 2 / 3.0, 1e-12);
  // A drum of diameter 1: its disc, and a rectangle from the side.
  web.shape = OpeningShape::upright_cylinder;
  web.opening = Vector(1, 1, 0.5);
  EXPECT_NEAR(projected_opening(web, frame, slanted), std::numbers::pi / 4 * 2 / 3 + 0.5 * std::sqrt(5.0) / 3, 1e-12);
  // A tube along x, of length 2 and diameter 0.5: its ends, and a rectangle from the side.
  web.shape = OpeningShape::cylinder_by_length;
  web.opening = Vector(0.5, 2, 0.5);
  EXPECT_NEAR(projected_opening(web, frame, slanted), std::numbers::pi / 4 * 0.25 / 3 + 2 * 0.5 * std::sqrt(8.0) / 3,
              1e-12);
  web.shape = OpeningShape::cylinder_by_width;
  web.opening = Vector(2, 0.5, 0.5);
  EXPECT_NEAR(projected_opening(web, frame, Vector::UnitX()), 1, 1e-12);
  // A sphere is a disc from all directions.
  web.shape = OpeningShape::ellipsoid;
  web.opening = Vector(1, 1, 1);
  EXPECT_NEAR(projected_opening(web, frame, slanted), std::numbers::pi / 4, 1e-12);
}

TEST(PositionIndex, BelowTheLineOfSightGrowsWithTheAngle) {
  // tan = 0.5: 1 + 0.8 * 0.5
  const Vector below = Vector(0, 1, -0.5).normalized();
  EXPECT_NEAR(position_index(below, Vector::UnitY(), Vector::UnitZ()), 1.4, 1e-12);
  EXPECT_NEAR(position_index(Vector(0, 1, -1).normalized(), Vector::UnitY(), Vector::UnitZ()), 2.2, 1e-12);
}

TEST(UnifiedGlareRating, OfFourLuminairesByHand) {
  // Each of 3,000 cd/m^2 and 0.01 sr; position indices 2, 2, 4, 8; background 40 cd/m^2. sum L^2 omega / p^2 =
  // 9e4 (1/4 + 1/4 + 1/16 + 1/64) = 52031.25; 8 log10(0.25 / 40 * 52031.25) = 8 log10(325.195) = 20.097.
  const std::vector<GlareSource> sources = {{3000, 0.01, 2}, {3000, 0.01, 2}, {3000, 0.01, 4}, {3000, 0.01, 8}};
  EXPECT_NEAR(*unified_glare_rating(sources, 40), 20.097, 1e-3);
  EXPECT_FALSE(unified_glare_rating({}, 40).has_value());
  EXPECT_FALSE(unified_glare_rating(sources, 0).has_value());
}

}  // namespace
}  // namespace patchlight::glare_test
