#include "mesh/outline.h"
#include "scene/simple_polygon.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace patchlight::coarse_outline_test {
namespace {

using namespace test;

constexpr double pi = std::numbers::pi;

// From one angle to another, including both ends.
std::vector<Point> arc(int edges, double radius, double from, double to) {
  std::vector<Point> points;
  for (int k = 0; k <= edges; ++k) {
    const double angle = from + (to - from) * k / edges;
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return points;
}

std::vector<Point> circle(int corners, double radius) {
  std::vector<Point> points = arc(corners, radius, 0, 2 * pi);
  points.pop_back();
  return points;
}

Scene scene_of(const std::vector<Point>& corners) { return with_polygon(empty_scene({grey(0.5)}), corners); }

std::vector<Point> coarse(const Scene& scene, PolygonIndex polygon, double max_edge) {
  return coarse_outline(scene, find_loose_corners(scene), polygon, max_edge);
}

double distance(const Point& point, const std::vector<Point>& outline) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point& from = outline[k];
    const Vector edge = outline[(k + 1) % outline.size()] - from;
    const double t = std::clamp((point - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (from + t * edge - point).norm());
  }
  return least;
}

double farthest(const std::vector<Point>& points, const std::vector<Point>& outline) {
  double most = 0;
  for (const Point& point : points) most = std::max(most, distance(point, outline));
  return most;
}

double area(const std::vector<Point>& outline) { return area_vector(outline).norm(); }

// The area is that of the outline, to rounding, and neither is farther from the other than the tolerance. A chord c of
// a circle is at most c^2 / 8r from it. Half of the tolerance goes to chords, half to the moves of corners. So edges
// are sqrt(8 r 0.005 e) long, rounded to whole numbers of edges.
TEST(CoarseOutline, OfADiscHasItsAreaAndIsNear) {
  const double radius = 2;
  for (const int corners : {60, 200, 1001, 10000}) {
    for (const double max_edge : {3.0, 1.0, 0.3}) {
      const std::vector<Point> outline = circle(corners, radius);
      const std::vector<Point> found = coarse(scene_of(outline), 0, max_edge);
      EXPECT_NEAR(area(found), area(outline), 1e-13 * area(outline));
      EXPECT_LE(farthest(outline, found), outline_tolerance * max_edge);
      EXPECT_LE(farthest(found, outline), outline_tolerance * max_edge);
      const double chord = std::sqrt(8 * radius * outline_tolerance / 2 * max_edge);
      const double edge = 2 * pi * radius / corners;
      const double expected = 2 * pi * radius / (std::floor(std::max(1.0, chord / edge)) * edge);
      EXPECT_LE(static_cast<double>(found.size()), std::ceil(expected) + 1) << corners << ' ' << max_edge;
      EXPECT_FALSE(crosses_itself(found));
    }
  }
}

// A disc never becomes a polygon of few corners, for patches of any size: its own width limits the edges.
TEST(CoarseOutline, OfASmallDiscIsRound) {
  const std::vector<Point> outline = circle(500, 0.01);
  const std::vector<Point> found = coarse(scene_of(outline), 0, 1e3);
  EXPECT_NEAR(area(found), area(outline), 1e-13 * area(outline));
  EXPECT_LE(farthest(outline, found), outline_tolerance * 0.02);
  EXPECT_GE(found.size(), 12u);
}

TEST(CoarseOutline, KeepsTheStraightSideOfAHalfDisc) {
  const std::vector<Point> outline = arc(300, 1, 0, pi);
  const std::vector<Point> found = coarse(scene_of(outline), 0, 0.5);
  EXPECT_LT(found.size(), 40u);
  EXPECT_NEAR(area(found), area(outline), 1e-13);
  EXPECT_EQ(std::count(found.begin(), found.end(), outline.front()), 1);
  EXPECT_EQ(std::count(found.begin(), found.end(), outline.back()), 1);
  for (const Point& point : found) EXPECT_GE(point.y(), 0);
}

TEST(CoarseOutline, OfASquareWithCutSidesIsTheSquare) {
  std::vector<Point> outline;
  const std::vector<Point> square = {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  for (std::size_t k = 0; k < 4; ++k) {
    for (int i = 0; i < 16; ++i) outline.push_back(square[k] + i / 16.0 * (square[(k + 1) % 4] - square[k]));
  }
  EXPECT_EQ(coarse(scene_of(outline), 0, 0.5), square);
}

// Every corner is kept if there are few, if edges are as long as patches, or if the outline turns sharply.
TEST(CoarseOutline, KeepsWhatIsNotFine) {
  EXPECT_EQ(coarse(scene_of(circle(24, 1)), 0, 10), circle(24, 1));
  EXPECT_EQ(coarse(scene_of(circle(200, 1)), 0, 2 * pi / 201), circle(200, 1));
  std::vector<Point> gear;
  for (int k = 0; k < 80; ++k) gear.push_back((k % 2 == 0 ? 1 : 0.9) * circle(80, 1)[static_cast<std::size_t>(k)]);
  EXPECT_EQ(coarse(scene_of(gear), 0, 1), gear);
}

// Walls of a cylinder keep every corner of its lids. Walls along a part of the rim keep this part.
TEST(CoarseOutline, KeepsCornersThatAThirdFaceHas) {
  const std::vector<Point> rim = circle(200, 1);
  Scene scene = scene_of(rim);
  for (std::size_t k = 0; k < 100; ++k)
    scene = with_quad(std::move(scene), {rim[k + 1], rim[k], rim[k] + Vector(0, 0, 1), rim[k + 1] + Vector(0, 0, 1)});
  const std::vector<Point> found = coarse(scene, 0, 0.5);
  for (std::size_t k = 0; k <= 100; ++k) EXPECT_EQ(std::count(found.begin(), found.end(), rim[k]), 1) << k;
  EXPECT_LT(found.size(), 135u);
  EXPECT_NEAR(area(found), area(rim), 1e-13);
}

// A lamp in the round hole of a ceiling. Both follow the same points, bit by bit, in any order and with any first
// corner. The area of both stays.
TEST(CoarseOutline, IsTheSameForTwoFacesOnEitherSide) {
  const std::vector<Point> lamp = circle(120, 1);
  std::vector<Point> ceiling = circle(400, 3);
  ceiling.push_back(ceiling.front());
  for (std::size_t k = 0; k <= lamp.size(); ++k) ceiling.push_back(lamp[(lamp.size() - k) % lamp.size()]);
  const std::vector<Point> turned_lamp(lamp.rbegin(), lamp.rend());
  for (const auto& one : {lamp, turned_lamp}) {
    for (const bool lamp_first : {true, false}) {
      const Scene scene = with_polygon(scene_of(lamp_first ? one : ceiling), lamp_first ? ceiling : one);
      const std::vector<Point> of_lamp = coarse(scene, lamp_first ? 0 : 1, 0.7);
      const std::vector<Point> of_ceiling = coarse(scene, lamp_first ? 1 : 0, 0.7);
      EXPECT_LT(of_lamp.size(), 60u);
      EXPECT_NEAR(area(of_lamp), area(lamp), 1e-13);
      EXPECT_NEAR(area(of_ceiling), area(ceiling), 1e-12);
      for (const Point& point : of_lamp) EXPECT_GE(std::count(of_ceiling.begin(), of_ceiling.end(), point), 1);
    }
  }
}

// A curved slit narrower than the tolerance, whose chords on both sides would cross.
TEST(CoarseOutline, ThatWouldCrossItselfIsNotTaken) {
  std::vector<Point> outline = {Point(0, 3, 0), Point(-3, 3, 0), Point(-3, -3, 0), Point(3, -3, 0), Point(3, 3, 0)};
  for (const Point& point : arc(100, 1.001, pi / 2, -pi / 2)) outline.push_back(point);
  for (const Point& point : arc(137, 1, -pi / 2, pi / 2)) outline.push_back(point);
  ASSERT_FALSE(crosses_itself(outline));
  EXPECT_EQ(coarse(scene_of(outline), 0, 1), outline);
}

}  // namespace
}  // namespace patchlight::coarse_outline_test
