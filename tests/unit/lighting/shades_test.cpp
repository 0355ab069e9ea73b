#include "lighting/shades.h"

#include "base/sampling.h"
#include "light/pane.h"
#include "lighting/direct_irradiance.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::shades_test {
namespace {

using namespace test;

// A floor of 2 x 2 m under a slanting sun.
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
  return direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, {.seed = seed});
}

TEST(Shades, AreSampledWhereThereAreTooMany) {
  // One patch by rays, compared with 64 by outlines, within three standard errors of the mean of 40 seeds. The scatter
  // of the seeds matches the stated error, which four replicates estimate without bias: 40 errors are known to 11 %.
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
  // A roof of 3,200 triangles, one of which has a hole of 1 mm. Possibly none of 4,096 rays finds it, so 3 / 4,096 of
  // the sun may be missed.
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

// Solid angle of the rectangle between the foot of a point at this height and (x, y).
double solid_angle(double x, double y, double height) {
  return std::atan(x * y / (height * std::sqrt(x * x + y * y + height * height)));
}

// A floor of 2 x 2 m under a roof with a square hole, and a point of 3 W/sr above it. The flux through the hole is 3
// W/sr times the hole's solid angle. Rays alone miss a hole of 2 cm.
TEST(Shades, OfALuminaireLeaveWhatFallsThroughASmallHole) {
  for (const double edge : {0.002, 0.02, 0.2}) {
    for (const double size : {1.0, 1e-3}) {
      const double x = 0.7, y = 0.65;
      Scene scene =
          with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
      const auto piece = [&](double x0, double y0, double x1, double y1) {
        scene = with_quad(std::move(scene), {Point(x0, y0, 1), Point(x1, y0, 1), Point(x1, y1, 1), Point(x0, y1, 1)});
      };
      piece(-9, -9, 9, y);
      piece(-9, y + edge, 9, 9);
      piece(-9, y, x, y + edge);
      piece(x + edge, y, 9, y + edge);
      const Point lamp(0.9, 0.9, 1.4);
      Luminaire luminaire;
      luminaire.position = lamp;
      luminaire.light = PointLight{Spectrum::Constant(1, 3)};
      scene.luminaires.push_back(luminaire);
      const Eigen::AngleAxisd turn(size == 1 ? 0.0 : 0.7, Vector(1, 2, 3).normalized());
      const DirectIrradiance direct =
          of_floor(moved(scene, Eigen::Affine3d(turn) * Eigen::Scaling(size)), 0.1001 * size);
      const double height = 0.4, near_x = lamp.x() - x - edge, near_y = lamp.y() - y - edge;
      const double hole = solid_angle(near_x + edge, near_y + edge, height) -
                          solid_angle(near_x, near_y + edge, height) - solid_angle(near_x + edge, near_y, height) +
                          solid_angle(near_x, near_y, height);
      const double area = 0.01 * size * size;
      const double flux = area * direct.irradiance.sum();
      const double error = area * std::sqrt(direct.standard_error.square().sum());
      EXPECT_NEAR(flux, 3 * hole, 3 * error) << edge;
      EXPECT_NEAR(flux, 3 * hole, 0.05 * 3 * hole) << edge;
    }
  }
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
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh);
  EXPECT_NEAR((direct.irradiance.row(0) - rgb(0.6, 0.75, 1)).abs().maxCoeff(), 0, 1e-14);
}

// A floor of 2 x 2 m, a pane at 1 m whose shadow ends at x = 1.53 m, and a point of 1 W/sr at 1.5 m.
Scene floor_under_a_pane() {
  Scene scene = empty_scene({grey(0.5), grey(0)});
  scene.materials[1].transmittance = Spectrum::Constant(1, 0.8);
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  scene = with_quad(std::move(scene), {Point(-9, -9, 1), Point(0.71, -9, 1), Point(0.71, 9, 1), Point(-9, 9, 1)}, 1);
  Luminaire luminaire;
  luminaire.position = Point(0.3, 0.4, 1.5);
  luminaire.light = PointLight{Spectrum::Constant(1, 1)};
  scene.luminaires.push_back(luminaire);
  return scene;
}

TEST(Shades, OfAPaneBeforeAPointAreItsTransmittanceAtEachAngle) {
  // E = T(cos) cos / d^2 of the floor's patches, which lie behind the pane wholly, partly, or not at all, by 400 points
  // of each. A patch of 0.25 m has parts of 6 cm, over which T varies by up to 4 %.
  const Scene scene = floor_under_a_pane();
  const Pane pane = pane_of(1.52, 0.8);
  Scene floor = scene;
  floor.polygons.resize(1);
  const PatchMesh mesh = tessellate(floor, kept_sides(floor, Sides::front), 0.2501);
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh);
  const Point lamp = scene.luminaires[0].position;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    double expected = 0;
    constexpr int cuts = 20;
    for (int k = 0; k < cuts * cuts; ++k) {
      const Point at = square_to_quad(mesh.corner_points(i).points, (k % cuts + 0.5) / cuts, (k / cuts + 0.5) / cuts);
      const Vector way = lamp - at;
      const double cosine = way.z() / way.norm();
      const bool is_behind = at.x() + way.x() / 1.5 < 0.71;
      expected += (is_behind ? transmittance(pane, cosine) : 1) * cosine / way.squaredNorm() / (cuts * cuts);
    }
    // With points a twentieth of a patch apart, the error on the edge is 1 / 40 of 1 - T.
    EXPECT_NEAR(direct.irradiance(i, 0), expected, 3 * direct.standard_error(i, 0) + 0.005 * expected) << i;
    EXPECT_LT(direct.standard_error(i, 0), 0.01 * expected) << i;
  }
}

}  // namespace
}  // namespace patchlight::shades_test
