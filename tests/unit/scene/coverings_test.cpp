#include "scene/coverings.h"

#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::coverings_test {
namespace {

using namespace test;

Quad rectangle(double x0, double y0, double x1, double y1, double z = 0) {
  return {Point(x0, y0, z), Point(x1, y0, z), Point(x1, y1, z), Point(x0, y1, z)};
}

Quad turned(const Quad& quad) { return {quad[3], quad[2], quad[1], quad[0]}; }

Scene scene_of(const std::vector<Quad>& quads) {
  Scene scene = empty_scene({grey(0.5), grey(0.5, 1)});
  for (const Quad& quad : quads) scene = with_quad(std::move(scene), quad);
  return scene;
}

using Over = std::vector<PolygonIndex>;

Over over(const Scene& scene, PolygonIndex polygon, Side side = Side::front, Sides sides = Sides::front) {
  const Coverings coverings = find_coverings(scene, kept_sides(scene, sides));
  const auto found = coverings.over_side(polygon, side);
  return {found.begin(), found.end()};
}

const Quad floor_quad = rectangle(0, 0, 4, 4);

TEST(Coverings, NeighboursInOnePlaneAndPolygonsOneAboveTheOtherCoverNothing) {
  const Scene scene = scene_of({floor_quad, rectangle(4, 0, 8, 4), rectangle(1, 1, 2, 2, 0.001)});
  EXPECT_TRUE(find_coverings(scene, kept_sides(scene, Sides::both)).over.empty());
}

TEST(Coverings, TheSmallerLiesOverTheLargerInAnyOrder) {
  const Quad rug = rectangle(1, 1, 2, 5);
  EXPECT_EQ(over(scene_of({floor_quad, rug}), 0), Over{1});
  EXPECT_EQ(over(scene_of({floor_quad, rug}), 1), Over{});
  EXPECT_EQ(over(scene_of({rug, floor_quad}), 1), Over{0});
}

TEST(Coverings, OfEqualOnesTheFirstLiesOver) {
  const Quad shifted = rectangle(2, 1, 6, 5);
  EXPECT_EQ(over(scene_of({floor_quad, shifted}), 1), Over{0});
  EXPECT_EQ(over(scene_of({floor_quad, shifted}), 0), Over{});
}

// Stored form factors are used again with other lamps. So coverings depend only on lamps that are faces of solids.
TEST(Coverings, DoNotDependOnLampsButALampThatIsCoveredIsNamed) {
  Scene scene = scene_of({rectangle(1, 1, 2, 2)});
  scene = with_quad(std::move(scene), floor_quad, 1);
  EXPECT_EQ(over(scene, 1), Over{0});
  const Coverings coverings = find_coverings(scene, kept_sides(scene, Sides::front));
  const Diagnostics problems = problems_with_overlaps(scene, coverings);
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].code, DiagnosticCode::covered_lamp);
  EXPECT_EQ(problems[1].code, DiagnosticCode::overlapping_faces);
  EXPECT_EQ(problems[1].count, 1U);
}

TEST(Coverings, OnlySidesThatFaceTheSameWayAndAreKeptCover) {
  const Scene scene = scene_of({floor_quad, turned(rectangle(1, 1, 2, 2))});
  EXPECT_EQ(over(scene, 0), Over{});  // the rug's front faces down, and its back is not kept
  EXPECT_EQ(over(scene, 0, Side::front, Sides::both), Over{1});
  EXPECT_EQ(over(scene, 0, Side::back, Sides::both), Over{1});
}

// Polygon 0 is a floor with both sides. Polygon 1 is the bottom of a box on it, and 7 a rug with one side.
TEST(Coverings, AFaceSeenFromBothSidesLiesOverASolidThatStandsAgainstIt) {
  Scene scene = with_box(scene_of({floor_quad}), Point(1, 1, 0), Point(2, 2, 1), false);
  scene = with_quad(std::move(scene), rectangle(2.5, 2.5, 3.5, 3.5));
  for (const bool has_inner_sides : {false, true}) {
    scene.polygons[1].material = 0;
    KeptSides kept = kept_sides(scene, Sides::both);
    if (!has_inner_sides) std::fill(kept.back.begin() + 1, kept.back.end(), 0);
    const Coverings standing = find_coverings(scene, kept);
    EXPECT_FALSE(standing.lies_over(1, 0, Side::back));
    EXPECT_TRUE(standing.lies_over(0, 1, Side::front));
    EXPECT_TRUE(standing.lies_over(7, 0, Side::front)) << "a rug is no solid";
    ASSERT_EQ(problems_with_overlaps(scene, standing).size(), 2U) << "the rug's floor, and the box";
    // A lamp recessed into a ceiling shines.
    scene.polygons[1].material = 1;
    const Coverings let_in = find_coverings(scene, kept);
    EXPECT_TRUE(let_in.lies_over(1, 0, Side::back));
    EXPECT_FALSE(let_in.lies_over(0, 1, Side::front));
  }
}

// Three faces overlap in one plane: a floor with both sides, polygon 0, a lamp in the side of a solid, 1, and the side
// of a smaller solid, 7. No two of them cover each other.
TEST(Coverings, OfThreeThatOverlapOneIsInSight) {
  Scene scene = with_box(scene_of({floor_quad}), Point(1, 1, 0), Point(3, 3, 1), false);
  scene = with_box(std::move(scene), Point(1.5, 1.5, 0), Point(2, 2, 0.5), false);
  scene.polygons[1].material = 1;
  const Coverings found = find_coverings(scene, kept_sides(scene, Sides::both));
  EXPECT_TRUE(found.lies_over(1, 0, Side::back));
  EXPECT_TRUE(found.lies_over(7, 0, Side::back));
  EXPECT_TRUE(found.lies_over(7, 1, Side::front));
  EXPECT_TRUE(found.over_side(7, Side::front).empty());
}

TEST(Coverings, PolygonsThatRoundingSetsApartLieInOnePlane) {
  // The extent is 6: 1e-6 is below 3e-7 of it, but 3e-6 is not. The order in depth does not matter.
  for (const double height : {1e-6, -1e-6}) {
    EXPECT_EQ(over(scene_of({floor_quad, rectangle(1, 1, 2, 2, height)}), 0), Over{1});
    EXPECT_EQ(over(scene_of({floor_quad, rectangle(1, 1, 2, 2, 3 * height)}), 0), Over{});
  }
}

TEST(Coverings, AFrameAroundAHoleIsNotCoveredByWhatFillsTheHole) {
  // A 4 x 4 frame around a 2 x 2 hole, joined by a seam, and the pane in it.
  Scene scene = empty_scene({grey(0.5)});
  scene =
      with_polygon(std::move(scene), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0), Point(0, 0, 0),
                                      Point(1, 1, 0), Point(1, 3, 0), Point(3, 3, 0), Point(3, 1, 0), Point(1, 1, 0)});
  scene = with_quad(std::move(scene), rectangle(1, 1, 3, 3));
  EXPECT_TRUE(find_coverings(scene, kept_sides(scene, Sides::both)).over.empty());
}

}  // namespace
}  // namespace patchlight::coverings_test
