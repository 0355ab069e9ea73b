#include "form_factor/patch_shape.h"

#include "patchlight/scene/sides.h"

#include "mesh/mesher.h"
#include "support/scenes.h"

#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace patchlight::patch_shape_test {
namespace {

using namespace test;

// Two polygons, one patch each.
std::vector<PatchShape> shapes_of(const std::vector<Point>& first, const std::vector<Point>& second) {
  Scene scene = with_polygon(empty_scene({grey(0.5)}), first);
  scene = with_polygon(std::move(scene), second);
  return patch_shapes(tessellate(scene, kept_sides(scene, Sides::front), 1e3));
}

const std::vector<Point> square{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
const std::vector<Point> triangle{Point(0, 0, 0), Point(1.2, 0, 0), Point(0.3, 0.9, 0)};

// A polygon facing down, rotated by `tilt` about the y axis, at `place`.
std::vector<Point> facing_down(std::vector<Point> polygon, double tilt, const Point& place) {
  const Eigen::Affine3d motion =
      Eigen::Translation3d(place) * Eigen::AngleAxisd(std::numbers::pi + tilt, Vector::UnitY());
  for (Point& corner : polygon) corner = motion * corner;
  return polygon;
}

template <typename Rule>
double integral(const Rule& rule, const std::function<double(double, double)>& f) {
  double sum = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(rule.count); ++k)
    sum += rule.weight[k] * f(rule.x[k], rule.y[k]);
  return sum;
}

TEST(Quadrature, IntegratesPolynomialsExactly) {
  // Over the unit square, the integral of x^m y^n is 1 / ((m + 1)(n + 1)). Over a triangle with vertices 0, a, b, each
  // coordinate product of degree 2 has A/6 (a^2 + a b + b^2). Both rules must reproduce these, and the area.
  const auto shapes = shapes_of(square, facing_down(square, 0, Point(0, 0, 5)));
  const auto cubic = [](double x, double y) { return x * x * x + x * y * y; };
  EXPECT_NEAR(integral(shapes[0].coarse, cubic), 0.25 + 1.0 / 6, 1e-14);
  const auto quintic = [](double x, double y) { return x * x * x * x * x + x * x * y * y * y; };
  EXPECT_NEAR(integral(shapes[0].fine, quintic), 1.0 / 6 + 1.0 / 12, 1e-14);

  const auto triangles = shapes_of(triangle, facing_down(triangle, 0, Point(0, 0, 5)));
  const double area = 0.5 * 1.2 * 0.9;
  const auto square_of_x = [](double x, double) { return x * x; };
  const double second_moment = area / 6 * (1.2 * 1.2 + 1.2 * 0.3 + 0.3 * 0.3);
  for (const double weight_sum : {integral(triangles[0].coarse, [](double, double) { return 1.0; }),
                                  integral(triangles[0].fine, [](double, double) { return 1.0; })}) {
    EXPECT_NEAR(weight_sum, area, 1e-14);
  }
  EXPECT_NEAR(integral(triangles[0].coarse, square_of_x), second_moment, 1e-14);
  EXPECT_NEAR(integral(triangles[0].fine, square_of_x), second_moment, 1e-14);
}

TEST(UnoccludedExchangeArea, AgreesWithTheContourIntegralInEveryClass) {
  // Near, middle and far pairs, facing and straddling. The header guarantees 1e-3.
  for (const auto& polygon : {square, triangle}) {
    for (const double distance : {1.0, 3.5, 5.0, 9.0}) {
      for (const double tilt : {0.0, 0.6, 1.4, 1.7}) {
        const auto other = facing_down(polygon, tilt, Point(0.4, 0.2, distance));
        const auto shapes = shapes_of(polygon, other);
        if (orientation(shapes[0], shapes[1]) == Orientation::averted) continue;
        const double exact = contour_exchange_area(shapes[0].corners, shapes[1].corners);
        EXPECT_NEAR(unoccluded_exchange_area(shapes[0], shapes[1]), exact, 1e-3 * exact + 1e-12)
            << distance << " " << tilt;
      }
    }
  }
}

TEST(Orientation, TellsFacingStraddlingAndAverted) {
  const auto with = [&](const std::vector<Point>& other) {
    const auto shapes = shapes_of(square, other);
    return orientation(shapes[0], shapes[1]);
  };
  EXPECT_EQ(with(facing_down(square, 0, Point(1, 0, 1))), Orientation::facing);
  EXPECT_EQ(with(facing_down(square, std::numbers::pi, Point(0, 0, 1))), Orientation::averted);
  EXPECT_EQ(with({Point(2, 0, 0), Point(3, 0, 0), Point(3, 1, 0), Point(2, 1, 0)}), Orientation::averted);
  EXPECT_EQ(with({Point(2, 0, -1), Point(2, 0, 1), Point(2, 1, 1), Point(2, 1, -1)}), Orientation::straddling);
}

}  // namespace
}  // namespace patchlight::patch_shape_test
