#include "lighting/light_paths.h"

#include "light/pane.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace patchlight::light_paths_test {
namespace {

using namespace test;

Material glass(double transmittance) {
  Material material = grey(0.1);
  material.transmittance = Spectrum::Constant(1, transmittance);
  return material;
}

// A square of 2 x 2 m across the z axis.
Scene with_sheet(Scene scene, double z, MaterialIndex material) {
  return with_quad(std::move(scene), {Point(-1, -1, z), Point(1, -1, z), Point(1, 1, z), Point(-1, 1, z)}, material);
}

// Opaque, glass of 0.8 and glass of 0.5.
Scene nothing() { return empty_scene({grey(0.5), glass(0.8), glass(0.5)}); }

double share(const Scene& scene, const Segment& segment) {
  return LightPaths(scene, Tracing(scene)).transmittance({&segment, 1})(0, 0);
}

constexpr double rounding = 1e-14;

TEST(LightPaths, MultiplyTheOpeningsOnTheWay) {
  const Scene scene = with_sheet(with_sheet(with_sheet(nothing(), 0, 1), 1, 2), 2, 1);
  EXPECT_NEAR(share(scene, {Point(0.1, 0.2, -1), Point(0.1, 0.2, 3)}), 0.8 * 0.5 * 0.8, rounding);
  EXPECT_NEAR(share(scene, {Point(0.1, 0.2, 3), Point(0.1, 0.2, -1)}), 0.8 * 0.5 * 0.8, rounding);
  EXPECT_NEAR(share(scene, {Point(0.1, 0.2, 0.5), Point(0.1, 0.2, 1.5)}), 0.5, rounding);
  EXPECT_EQ(share(scene, {Point(5, 0, -1), Point(5, 0, 3)}), 1);
}

TEST(LightPaths, TakeWhatPanesLetThroughAtTheirAngle) {
  // Panes of two indices, from either side, for any length of the path.
  Scene scene = nothing();
  scene.materials[2].index = 1.9;
  scene = with_sheet(with_sheet(std::move(scene), 0, 1), 0.1, 2);
  const double cosine = 1 / std::sqrt(1 + 0.6 * 0.6);
  const double expected = transmittance(pane_of(1.52, 0.8), cosine) * transmittance(pane_of(1.9, 0.5), cosine);
  EXPECT_LT(expected, 0.8 * 0.5 - 0.001);
  for (const double length : {0.4, 1.0, 7.0}) {
    const Point below(-0.3 * length, 0, -0.5 * length), above(0.3 * length, 0, 0.5 * length);
    EXPECT_NEAR(share(scene, {below, above}), expected, rounding);
    EXPECT_NEAR(share(scene, {above, below}), expected, rounding);
  }
}

TEST(LightPaths, EndBehindTheLastOpeningThatCounts) {
  // From one opening to another, and to a point before one.
  const Scene scene = with_sheet(with_sheet(with_sheet(nothing(), 0, 1), 1, 2), 2, 1);
  EXPECT_NEAR(share(scene, {Point(0, 0, 0), Point(0, 0, 2), 0, 2}), 0.5, rounding);
  EXPECT_NEAR(share(scene, {Point(0, 0, -1), Point(0, 0, 0.9)}), 0.8, rounding);
}

// Rays that cross no opening, one, two or three, and a blocked one.
TEST(LightPaths, AreTheSameForManySegmentsAsForEach) {
  Scene scene = with_sheet(with_sheet(with_sheet(nothing(), 0, 1), 1, 2), 2, 1);
  scene = with_sheet(std::move(scene), 4, 0);
  const LightPaths paths(scene, Tracing(scene));
  std::vector<Segment> segments;
  for (const double end : {-0.5, 0.5, 1.5, 2.5, 5.0, 3.0, 0.7})
    segments.push_back({Point(0.1, 0.2, -1), Point(0.1, 0.2, end)});
  const std::vector<Passage> together = paths.passages(segments);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Passage alone = paths.passages({&segments[k], 1})[0];
    ASSERT_EQ(together[k].transmittance.size(), alone.transmittance.size()) << k;
    EXPECT_TRUE((together[k].transmittance == alone.transmittance).all()) << k;
    ASSERT_EQ(together[k].crossings.size(), alone.crossings.size()) << k;
    for (std::size_t n = 0; n < alone.crossings.size(); ++n)
      EXPECT_EQ(together[k].crossings[n].distance, alone.crossings[n].distance);
  }
  EXPECT_EQ(together[3].crossings.size(), 3U);
  EXPECT_NEAR(together[3].crossings[2].distance, 3, 1e-6);
}

TEST(LightPaths, EndAtAnythingOpaque) {
  const Scene scene = with_sheet(with_sheet(nothing(), 0, 1), 1, 0);
  EXPECT_EQ(share(scene, {Point(0, 0, -1), Point(0, 0, 3)}), 0);
  EXPECT_NEAR(share(scene, {Point(0, 0, -1), Point(0, 0, 0.5)}), 0.8, rounding);
  // On the scene's convex hull, too, which does not block segments between its points.
  EXPECT_EQ(share(with_sheet(nothing(), 0, 0), {Point(0, 0, -1), Point(0, 0, 1)}), 0);
}

TEST(LightPaths, GoFromTheOutsideOfAnEmptyWindow) {
  const Scene scene = with_sheet(nothing(), 0, 0);
  EXPECT_EQ(share(scene, {Point(2, 0, -1), Point(2, 0, 1)}), 1);
}

TEST(LightPaths, BeyondIsOutsideTheScene) {
  const Scene scene = with_box(nothing(), Point(0, 0, 0), Point(4, 3, 2), true);
  const LightPaths paths(scene, Tracing(scene));
  for (const Vector& direction : {Vector(1, 0, 0), Vector(-0.6, 0, 0.8), Vector(0, 1, 0)}) {
    EXPECT_FALSE(bounds(scene).contains(paths.beyond(Point(1, 1, 1), direction)));
    EXPECT_FALSE(bounds(scene).contains(paths.beyond(Point(-9, 1, 1), direction)));
  }
}

TEST(LightPaths, KeepTheBandsApart) {
  Scene scene = empty_scene({{"opaque", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}, {"tinted", rgb(0, 0, 0), rgb(0, 0, 0)}});
  scene.materials[1].transmittance = rgb(0.9, 0.5, 0);
  scene = with_sheet(with_sheet(std::move(scene), 0, 1), 1, 1);
  const Segment segment{Point(0, 0, -1), Point(0, 0, 3)};
  const Field share = LightPaths(scene, Tracing(scene)).transmittance({&segment, 1});
  EXPECT_NEAR(share(0, 0), 0.9 * 0.9, rounding);
  EXPECT_NEAR(share(0, 1), 0.25, rounding);
  EXPECT_EQ(share(0, 2), 0);
}

// Every ray arrives if no face can hide a ball. If a face does hide it, the test for possible blockers finds it. Random
// balls and points among plates, one of them a pane, in two sizes.
TEST(LightPaths, NothingHidesABallThatMayNotBeHidden) {
  for (const double size : {1.0, 1e-3}) {
    Scene scene = empty_scene({grey(0.5), grey(0)});
    scene.materials[1].transmittance = Spectrum::Constant(1, 0.5);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto anywhere = [&] { return Point(size * Point(uniform(random), uniform(random), uniform(random))); };
    for (int k = 0; k < 6; ++k) {
      const Point a = anywhere();
      const Vector u = 0.6 * anywhere(), v = 0.6 * anywhere();
      scene = with_quad(std::move(scene), {a, a + u, a + u + v, a + v}, k == 0 ? 1 : 0);
    }
    const LightPaths paths(scene, Tracing(scene));
    int free = 0;
    int hidden = 0;
    for (int k = 0; k < 400; ++k) {
      const Point place = anywhere();
      const Point centre = anywhere();
      const double radius = 0.05 * size;
      const Vector normal = (centre - place).normalized();
      const bool may_be_hidden = paths.may_be_hidden({&place, 1}, normal, centre, radius);
      std::vector<Segment> rays;
      for (int ray = 0; ray < 64; ++ray) rays.push_back({place, centre + radius * (anywhere() / size).normalized()});
      const bool arrives = (paths.transmittance(rays) == 1).all();
      if (!may_be_hidden) {
        EXPECT_TRUE(arrives) << k;
      }
      (arrives ? free : hidden) += 1;
    }
    EXPECT_GT(free, 100);
    EXPECT_GT(hidden, 20);
  }
}

}  // namespace
}  // namespace patchlight::light_paths_test
