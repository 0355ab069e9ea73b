#include "form_factor/patch_shape.h"
#include "form_factor/point_polygon.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::contour_test {
namespace {

using Square = std::array<Point, 4>;

const Square floor_square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};

Square moved(const Square& square, const Eigen::Isometry3d& motion, double scale = 1) {
  Square result;
  for (std::size_t k = 0; k < 4; ++k) result[k] = scale * (motion * square[k]);
  return result;
}

// A rectangle hinged to the floor square's edge on the y axis, at `angle` from the floor. Its front faces the floor.
Square hinged(double angle) {
  const Vector along(std::cos(angle), 0, std::sin(angle));
  return {Point(0, 0, 0), Point(0, 1, 0), Point(Point(0, 1, 0) + along), Point(along)};
}

// Unit squares facing each other at distance 1, and sharing an edge at 90 degrees: closed forms C-11 and C-14 of
// Howell's catalog, evaluated to 16 digits.
constexpr double opposed = 0.19982489569838732;
constexpr double perpendicular = 0.20004377607540316;

TEST(ContourExchangeArea, OpposedUnitSquares) {
  const Square ceiling{Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)};
  EXPECT_NEAR(contour_exchange_area(floor_square, ceiling), opposed, 1e-9);
}

TEST(ContourExchangeArea, UnitSquaresSharingAnEdge) {
  EXPECT_NEAR(contour_exchange_area(floor_square, hinged(std::numbers::pi / 2)), perpendicular, 1e-7);
}

TEST(ContourExchangeArea, IsSymmetric) {
  // Both orders integrate the same function with the inner and outer integral exchanged. They agree to the quadrature's
  // error.
  for (const double degrees : {10.0, 60.0, 90.0, 150.0}) {
    const Square wall = hinged(degrees * std::numbers::pi / 180);
    EXPECT_NEAR(contour_exchange_area(floor_square, wall), contour_exchange_area(wall, floor_square), 1e-6) << degrees;
  }
}

TEST(ContourExchangeArea, IsInvariantUnderMotionAndScalesWithArea) {
  const Square wall = hinged(1.0);
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(3, -2, 5) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized());
  const double here = contour_exchange_area(floor_square, wall);
  const double there = contour_exchange_area(moved(floor_square, motion, 100), moved(wall, motion, 100));
  // Rounding of coordinates of size 600 against edges of length 100, relative to a result of 2e3 m^2.
  EXPECT_NEAR(there, 1e4 * here, 1e-8 * 1e4);
}

TEST(ContourExchangeArea, AddsUpOverParts) {
  const Square wall = hinged(2.0);
  const auto strip = [&](int k) {
    const double lower = k / 3.0;
    const double upper = (k + 1) / 3.0;
    return Square{Point(lower, 0, 0), Point(upper, 0, 0), Point(upper, 1, 0), Point(lower, 1, 0)};
  };
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += contour_exchange_area(strip(k), wall);
  EXPECT_NEAR(sum, contour_exchange_area(floor_square, wall), 1e-6);
}

TEST(ContourExchangeArea, IsZeroForAvertedAndCoplanarPolygons) {
  const Square beside{Point(1, 0, 0), Point(2, 0, 0), Point(2, 1, 0), Point(1, 1, 0)};
  const Square below{Point(0, 0, -1), Point(1, 0, -1), Point(1, 1, -1), Point(0, 1, -1)};
  EXPECT_EQ(contour_exchange_area(floor_square, below), 0);
  // Sixteen terms of size 1/(2 pi) cancel, with a few roundings each.
  EXPECT_NEAR(contour_exchange_area(floor_square, beside), 0, 1e-14);
}

TEST(ContourExchangeArea, ClipsWhatLiesBehindTheOthersPlane) {
  // Only the upper half of a wall that reaches 1 m below the floor sees the floor.
  const Square half{Point(0, 0, 0), Point(0, 1, 0), Point(0, 1, 1), Point(0, 0, 1)};
  const Square whole{Point(0, 0, -1), Point(0, 1, -1), Point(0, 1, 1), Point(0, 0, 1)};
  EXPECT_NEAR(contour_exchange_area(floor_square, whole), contour_exchange_area(floor_square, half), 1e-12);
}

TEST(PointToPolygon, RectangleOverItsCorner) {
  // Element below a corner of an a x b rectangle at distance c, parallel: F = (1/2pi) [X/sqrt(1+X^2)
  // atan(Y/sqrt(1+X^2)) + Y/sqrt(1+Y^2) atan(X/sqrt(1+Y^2))], X = a/c, Y = b/c (Howell, B-3).
  const double X = 2;
  const double Y = 3;
  const Square ceiling{Point(0, 0, 1), Point(0, Y, 1), Point(X, Y, 1), Point(X, 0, 1)};
  const double x = std::sqrt(1 + X * X);
  const double y = std::sqrt(1 + Y * Y);
  const double expected = (X / x * std::atan(Y / x) + Y / y * std::atan(X / y)) / (2 * std::numbers::pi);
  EXPECT_NEAR(point_to_polygon(Point::Zero(), Vector::UnitZ(), ceiling), expected, 1e-14);
}

TEST(PointToPolygon, FivePolygonsOfAnOpenCubeFillTheHemisphere) {
  const Point eye(0.3, 0.6, 0);
  const Square ceiling{Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)};
  double sum = point_to_polygon(eye, Vector::UnitZ(), ceiling);
  const Point centre(0.5, 0.5, 0);
  for (int k = 0; k < 4; ++k) {
    const Eigen::Isometry3d turn = Eigen::Translation3d(centre) *
                                   Eigen::AngleAxisd(k * std::numbers::pi / 2, Vector::UnitZ()) *
                                   Eigen::Translation3d(-centre);
    sum += point_to_polygon(eye, Vector::UnitZ(), moved(hinged(std::numbers::pi / 2), turn));
  }
  EXPECT_NEAR(sum, 1, 1e-14);
}

TEST(PointToPolygon, SeesNothingFromBehind) {
  EXPECT_EQ(point_to_polygon(Point(0.5, 0.5, -1), Vector::UnitZ(), floor_square), 0);
  EXPECT_EQ(point_to_polygon(Point(0.5, 0.5, 1), Vector::UnitZ(), floor_square), 0);
  EXPECT_GT(point_to_polygon(Point(0.5, 0.5, 1), -Vector::UnitZ(), floor_square), 0.2);
}

TEST(PointToPolygon, AveragesToTheContourIntegral) {
  // The mean over a uniform grid of midpoints on a distant square; the midpoint rule's error falls with h^2.
  const Square ceiling{Point(0, 0, 2), Point(0, 1, 2), Point(1, 1, 2), Point(1, 0, 2)};
  const auto midpoint_mean = [&](int n) {
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        sum += point_to_polygon(Point((i + 0.5) / n, (j + 0.5) / n, 0), Vector::UnitZ(), ceiling);
      }
    }
    return sum / (n * n);
  };
  const double exact = contour_exchange_area(floor_square, ceiling);
  const double coarse = std::abs(midpoint_mean(8) - exact);
  const double fine = std::abs(midpoint_mean(16) - exact);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

}  // namespace
}  // namespace patchlight::contour_test
