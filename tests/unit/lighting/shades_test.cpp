#include "lighting/shades.h"

#include "patchlight/base/sampling.h"
#include "patchlight/lighting/direct_irradiance.h"
#include "patchlight/mesh/mesher.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::shades_test {
namespace {

using namespace test;

// A floor of 2 x 2 m, with the sun at a slant over it.
Scene sunny_floor() {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  scene.sun = Sun{Vector(0.3, 0.2, 0.8).normalized(), Spectrum::Constant(1, 10)};
  return scene;
}

// The same under 1,600 leaves of 3 cm on average, too many for the outlines of their shadows.
Scene floor_under_leaves() {
  Scene scene = sunny_floor();
  for (std::uint32_t k = 0; k < 1600; ++k) {
    const auto random = [&](std::uint32_t d) { return hash({k, d}) * 0x1p-32; };
    const Point middle(2.5 * random(0), 2.5 * random(1), 0.5 + random(2));
    const auto corner = [&](std::uint32_t d) {
      return Point(middle + 0.08 * Vector(random(d) - 0.5, random(d + 1) - 0.5, random(d + 2) - 0.5));
    };
    scene = with_polygon(std::move(scene), {corner(3), corner(6), corner(9)});
  }
  return scene;
}

DirectIrradiance of_floor(const Scene& scene, double max_edge, std::uint64_t seed = 1) {
  Scene floor = scene;
  floor.polygons.resize(1);
  const PatchMesh mesh = tessellate(floor, kept_sides(floor, Sides::front), max_edge);
  return direct_irradiance(lighting_of(scene), mesh, {.seed = seed});
}

TEST(Shades, AreSampledWhereThereAreTooMany) {
  // One patch by rays against 64 by their outlines. Three standard errors of 40 seeds' mean; the scatter of the seeds
  // is the stated error, which four replicates tell without bias: 40 errors are known to 11 %.
  const Scene scene = floor_under_leaves();
  const DirectIrradiance fine = of_floor(scene, 0.25);
  ASSERT_EQ(fine.irradiance.rows(), 64);
  EXPECT_EQ(fine.standard_error.maxCoeff(), 0);
  const double expected = fine.irradiance.mean();
  double squared_error = 0;
  double variance = 0;
  double sum = 0;
  constexpr int seeds = 40;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const DirectIrradiance coarse = of_floor(scene, 2, seed);
    ASSERT_EQ(coarse.irradiance.rows(), 1);
    squared_error += std::pow(coarse.irradiance(0, 0) - expected, 2);
    variance += std::pow(coarse.standard_error(0, 0), 2);
    sum += coarse.irradiance(0, 0);
  }
  EXPECT_GT(variance, 0);
  EXPECT_NEAR(sum / seeds, expected, 3 * std::sqrt(variance) / seeds);
  EXPECT_GT(std::sqrt(squared_error / variance), 0.7);
  EXPECT_LT(std::sqrt(squared_error / variance), 1.3);
}

TEST(Shades, OfRaysThatAllFindNothingAreKnownByTheRuleOfThree) {
  // A roof of 3,200 triangles, in one of which there is a hole of 1 mm: no ray of 4,096 need find it, so that 3 / 4,096
  // of the sun may be missed.
  Scene scene = sunny_floor();
  constexpr int cells = 40;
  const double edge = 4.0 / cells;
  for (int x = 0; x < cells; ++x) {
    for (int y = 0; y < cells; ++y) {
      const auto p = [&](int i, int j) { return Point((x + i) * edge - 0.5, (y + j) * edge - 0.5, 1); };
      scene = with_polygon(std::move(scene), {p(0, 0), p(1, 0), p(1, 1)});
      scene = with_polygon(std::move(scene),
                           {p(0, 0), p(1, 1), x == 20 && y == 20 ? p(0, 1) - Point(0.001, 0, 0) : p(0, 1)});
    }
  }
  const DirectIrradiance direct = of_floor(scene, 2);
  const double unshadowed = 10 * 0.8 / std::sqrt(0.77);
  EXPECT_EQ(direct.irradiance(0, 0), 0);
  EXPECT_NEAR(direct.standard_error(0, 0), 3.0 / 4096 * unshadowed, 1e-12);
}

TEST(Shades, OfAPaneAreItsTransmittancePerBand) {
  Scene scene = empty_scene({{"wall", rgb(0.5, 0.5, 0.5), rgb(0, 0, 0)}, {"glass", rgb(0, 0, 0), rgb(0, 0, 0)}});
  scene.materials[1].transmittance = rgb(0.2, 0.5, 1);
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(1, 0, 1), Point(1, 2, 1), Point(0, 2, 1)}, 1);
  scene.sun = Sun{Vector::UnitZ(), rgb(1, 1, 1)};
  Scene floor = scene;
  floor.polygons.resize(1);
  const PatchMesh mesh = tessellate(floor, kept_sides(floor, Sides::front), 2);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene), mesh);
  EXPECT_NEAR((direct.irradiance.row(0) - rgb(0.6, 0.75, 1)).abs().maxCoeff(), 0, 1e-14);
}

}  // namespace
}  // namespace patchlight::shades_test
