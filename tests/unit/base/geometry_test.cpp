#include "patchlight/base/geometry.h"

#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::geometry_test {
namespace {

// An L of three unit squares in the plane z = 5, counter-clockwise from above.
const std::vector<Point> ell{Point(0, 0, 5), Point(2, 0, 5), Point(2, 1, 5),
                             Point(1, 1, 5), Point(1, 2, 5), Point(0, 2, 5)};

TEST(AreaVector, OfAConcavePolygon) { EXPECT_LT((area_vector(ell) - Vector(0, 0, 3)).norm(), 1e-15); }

TEST(AreaCentroid, IsTheMeanOfTheParts) {
  // Squares at (0.5, 0.5), (1.5, 0.5), (0.5, 1.5).
  EXPECT_LT((area_centroid(ell) - Point(2.5 / 3, 2.5 / 3, 5)).norm(), 1e-15);
}

TEST(AreaVector, DoesNotLosePrecisionFarFromTheOrigin) {
  std::vector<Point> far = ell;
  for (Point& corner : far) corner += Vector(1e6, -1e6, 1e6);
  EXPECT_LT((area_vector(far) - Vector(0, 0, 3)).norm(), 1e-15);
}

TEST(ClipToHalfSpace, TwoHalvesMakeTheWhole) {
  const std::vector<Point> square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  const Point on_plane(0.3, 0.4, 0);
  const Vector normal = Vector(1, 0.5, 0.2).normalized();
  const double above = area_vector(clip_to_half_space(square, on_plane, normal)).norm();
  const double below = area_vector(clip_to_half_space(square, on_plane, -normal)).norm();
  EXPECT_GT(above, 0.1);
  EXPECT_NEAR(above + below, 1, 1e-15);
}

TEST(ClipToHalfSpace, KeepsAllOrNothing) {
  EXPECT_EQ(clip_to_half_space(ell, Point(0, 0, 4), Vector::UnitZ()).size(), ell.size());
  EXPECT_TRUE(clip_to_half_space(ell, Point(0, 0, 6), Vector::UnitZ()).empty());
}

// A square stands on the plane. It is rotated so that rounding lifts or lowers its lower corners. All four corners
// stay.
TEST(ClipToHalfSpace, CornersOnThePlaneStayHoweverItIsTurned) {
  const std::array<Point, 4> square{Point(0, 1, 0), Point(0, 2, 0), Point(0, 2, 1), Point(0, 1, 1)};
  for (int k = 0; k < 100; ++k) {
    const Eigen::AngleAxisd turn(0.1 * k, Vector(1, 2, 3).normalized());
    std::array<Point, 4> turned;
    for (std::size_t c = 0; c < 4; ++c) turned[c] = turn * square[c];
    const auto kept = clip_to_half_space(turned, turn * Point(0.3, 0.4, 0), turn * Vector::UnitZ());
    ASSERT_EQ(kept.size(), 4U);
    for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(kept[c], turned[c]);
  }
}

TEST(SignedSolidAngle, OfAnOctantAndOfAClosedTetrahedron) {
  const Point x(1, 0, 0);
  const Point y(0, 1, 0);
  const Point z(0, 0, 1);
  EXPECT_NEAR(signed_solid_angle(Point::Zero(), x, y, z), std::numbers::pi / 2, 1e-15);

  // Faces with outward normals.
  const Point o(0, 0, 0);
  const auto total = [&](const Point& eye) {
    return signed_solid_angle(eye, x, y, z) + signed_solid_angle(eye, o, y, x) + signed_solid_angle(eye, o, z, y) +
           signed_solid_angle(eye, o, x, z);
  };
  EXPECT_NEAR(total(Point(0.1, 0.2, 0.3)), 4 * std::numbers::pi, 1e-14);
  EXPECT_NEAR(total(Point(1, 1, 1)), 0, 1e-14);
}

}  // namespace
}  // namespace patchlight::geometry_test
