#include "visibility/occluder.h"

#include "base/sampling.h"
#include "support/scenes.h"
#include "visibility/flat_polygon.h"

#include <gtest/gtest.h>

namespace patchlight::occluder_test {
namespace {

using namespace test;

// A closed 2 x 2 x 2 room with a wall of no thickness at x = 1, polygon 6.
Scene divided_room() {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(2, 2, 2), true);
  return with_quad(std::move(scene), {Point(1, 0, 0), Point(1, 2, 0), Point(1, 2, 2), Point(1, 0, 2)});
}

TEST(Occluder, AWallBlocksFromBothSides) {
  const Occluder occluder(divided_room());
  const Point left(0.5, 1, 1);
  const Point right(1.5, 1, 1);
  const std::vector<Segment> segments{{left, right}, {right, left}, {left, Point(0.9, 0.2, 0.3)}};
  EXPECT_EQ(occluder.occluded(segments), (std::vector<std::uint8_t>{1, 1, 0}));
}

TEST(Occluder, EndPolygonsNeverBlock) {
  const Occluder occluder(divided_room());
  const Segment through{Point(0.5, 1, 1), Point(1.5, 1, 1), no_polygon, 6};
  EXPECT_EQ(occluder.occluded(std::vector<Segment>{through})[0], 0);
}

TEST(Occluder, NoLightUnderAWallThatStandsOnTheFloor) {
  // All segments from the floor left of the wall to the floor right of it cross the wall. Their ends are at least 1e-4
  // from it.
  const Occluder occluder(divided_room());
  std::vector<Segment> segments;
  for (const auto& [u, v, s, t] : scrambled_sobol(4096, 1)) {
    segments.push_back({Point(1 - 1e-4 - 0.9 * u, 2 * v, 0), Point(1 + 1e-4 + 0.9 * s, 2 * t, 1e-3), 0, no_polygon});
  }
  const auto blocked = occluder.occluded(segments);
  EXPECT_EQ(std::count(blocked.begin(), blocked.end(), 1), 4096);
}

TEST(Occluder, AnswersDoNotDependOnPositionAndScale) {
  // The same room 1e6 m away, and of 1e-6 and 1e6 times its size. Ends keep away from the wall's rim, where a hit may
  // change.
  const auto blocked = [&](double scale, const Vector& shift) {
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.translate(shift).scale(scale);
    Scene scene = moved(furnished_room(0.5), motion);
    std::vector<Segment> segments;
    for (const auto& [u, v, s, t] : scrambled_sobol(1024, 1)) {
      segments.push_back({motion * Point(4 * u, 3 * v, 0), motion * Point(4 * s, 3 * t, 2.4), 0, no_polygon});
    }
    return Occluder(scene).occluded(segments);
  };
  const auto here = blocked(1, Vector::Zero());
  EXPECT_GT(std::count(here.begin(), here.end(), 1), 50);
  EXPECT_EQ(blocked(1e-6, Vector::Zero()), here);
  EXPECT_EQ(blocked(1e6, Vector::Zero()), here);
  // 1e6 m away a double is exact to 1e-10 m: at most one segment that grazes an edge may change.
  const auto there = blocked(1, Vector(1e6, -1e6, 1e6));
  int changed = 0;
  for (std::size_t k = 0; k < here.size(); ++k) changed += here[k] != there[k];
  EXPECT_LE(changed, 1);
}

TEST(Occluder, AConvexRoomCannotOcclude) {
  EXPECT_FALSE(Occluder(cube_room(0.5, 1)).can_occlude());
  EXPECT_TRUE(Occluder(divided_room()).can_occlude());
}

// A closed room with a 1 x 1 rug drawn in the floor's plane, polygon 6.
Scene room_with_rug() {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(2, 2, 2), true);
  return with_quad(std::move(scene), {Point(0.5, 0.5, 0), Point(1.5, 0.5, 0), Point(1.5, 1.5, 0), Point(0.5, 1.5, 0)});
}

TEST(Occluder, ACoveredPlaceIsOutOfSight) {
  const Scene scene = room_with_rug();
  const Occluder occluder(scene, Occluder::Blockers::inside_hull,
                          find_coverings(scene, kept_sides(scene, Sides::front)));
  EXPECT_TRUE(occluder.can_occlude());
  const Point above(1.1, 0.9, 1.7);
  const Point below_rug(1, 1.1, 0);
  const Point beside(0.2, 1.1, 0);
  const std::vector<Segment> segments{{above, below_rug, no_polygon, 0},
                                      {below_rug, above, 0, no_polygon},
                                      {above, below_rug, no_polygon, 6},
                                      {above, beside, no_polygon, 0}};
  EXPECT_EQ(occluder.occluded(segments), (std::vector<std::uint8_t>{1, 1, 0, 0}));
  EXPECT_TRUE(occluder.is_covered(0, Side::front, below_rug));
  EXPECT_FALSE(occluder.is_covered(0, Side::back, below_rug));
  EXPECT_FALSE(occluder.is_covered(6, Side::front, below_rug));
}

TEST(Occluder, AWallWithAPaneDrawnOnItHidesNothingForSure) {
  Scene scene = divided_room();
  const std::vector<Point> left{Point(0.5, 1, 1)};
  const std::vector<Point> right{Point(1.5, 0.9, 0.9), Point(1.5, 1.1, 0.9), Point(1.5, 1, 1.1)};
  const auto hides = [&](Occluder::Blockers blockers) {
    const Occluder occluder(scene, blockers, find_coverings(scene, kept_sides(scene, Sides::both)));
    return occluder.hides(left, right);
  };
  EXPECT_TRUE(hides(Occluder::Blockers::opaque));
  EXPECT_TRUE(hides(Occluder::Blockers::all));
  scene.materials.push_back(grey(0.1));
  scene.materials.back().transmittance = Spectrum::Constant(1, 0.8);
  scene =
      with_quad(std::move(scene), {Point(1, 0.5, 0.5), Point(1, 1.5, 0.5), Point(1, 1.5, 1.5), Point(1, 0.5, 1.5)}, 1);
  const Occluder sees(scene, Occluder::Blockers::all, find_coverings(scene, kept_sides(scene, Sides::both)));
  EXPECT_GT(sees.transmittance(std::vector<Segment>{{left[0], right[0]}})[0], 0);
  EXPECT_FALSE(hides(Occluder::Blockers::opaque));
  EXPECT_FALSE(hides(Occluder::Blockers::all));
}

TEST(Occluder, ARayMeetsThePolygonThatLiesOver) {
  // Without the coverings Embree may find either. Here rays meet the rug inside its outline and the floor beside it,
  // for any order in the scene.
  for (const bool rug_first : {false, true}) {
    Scene scene = room_with_rug();
    if (rug_first) std::swap(scene.polygons[0], scene.polygons[6]);
    const PolygonIndex rug = rug_first ? 0 : 6;
    const Occluder occluder(scene, Occluder::Blockers::all, find_coverings(scene, kept_sides(scene, Sides::front)));
    std::vector<Ray> rays;
    for (const auto& [u, v, s, t] : scrambled_sobol(256, 1)) {
      const Point from(2 * u, 2 * v, 1.5);
      rays.push_back({from, (Point(0.02 + 1.96 * s, 0.02 + 1.96 * t, 0) - from).normalized()});
    }
    const auto hits = occluder.first_hits(rays);
    for (const auto& hit : hits) {
      ASSERT_TRUE(hit);
      const double away = std::max(std::abs(hit->point.x() - 1), std::abs(hit->point.y() - 1));
      if (std::abs(away - 0.5) > 1e-6) {
        EXPECT_EQ(hit->polygon == rug, away < 0.5);
      }
    }
  }
}

TEST(OnConvexHull, FindsTheOuterFaces) {
  const auto on_hull = on_convex_hull(furnished_room(0.5));
  EXPECT_EQ(std::count(on_hull.begin(), on_hull.begin() + 6, 1), 6);
  EXPECT_EQ(std::count(on_hull.begin() + 6, on_hull.end(), 1), 0);
}

TEST(FirstHits, GiveThePolygonItsSideAndThePoint) {
  const Occluder occluder(divided_room());
  const std::vector<Ray> rays{{Point(0.25, 1, 1), Vector::UnitX()},
                              {Point(1.75, 1.25, 0.5), -Vector::UnitX()},
                              {Point(1, 1, 1), Vector::UnitX(), 6},
                              {Point(5, 5, 5), Vector::UnitX()}};
  const auto hits = occluder.first_hits(rays);
  ASSERT_TRUE(hits[0] && hits[1] && hits[2]);
  EXPECT_EQ(hits[0]->polygon, 6U);
  EXPECT_EQ(hits[0]->side, Side::back);
  EXPECT_LT((hits[0]->point - Point(1, 1, 1)).norm(), 1e-12);
  EXPECT_NEAR(hits[0]->distance, 0.75, 1e-12);
  EXPECT_EQ(hits[1]->side, Side::front);
  EXPECT_EQ(hits[2]->polygon, 3U);
  EXPECT_FALSE(hits[3]);
}

TEST(FirstHits, NoRayLeavesAClosedRoom) {
  const Occluder occluder(cube_room(0.5, 1));
  std::vector<Ray> rays;
  for (const auto& [u, v, s, t] : scrambled_sobol(1 << 14, 9)) {
    rays.push_back({Point(u, v, 0), square_to_cosine_hemisphere(s, t), 0});
  }
  for (const auto& hit : occluder.first_hits(rays)) EXPECT_TRUE(hit && hit->side == Side::front);
}

}  // namespace
}  // namespace patchlight::occluder_test
