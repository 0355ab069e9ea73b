#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"

#include "base/parallel.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

// Lightmaps against laws of light.
namespace patchlight::lightmap_test {
namespace {

using namespace test;

Simulation solved_with_edge(const Scene& scene, double edge, bool with_error_bars = false) {
  Request request;
  request.mesh.max_edge = edge;
  request.accuracy.error_bars = with_error_bars;
  return simulate(scene, request);
}

// H of texels, W/m^2, in the first band.
Eigen::ArrayXd irradiance_of(const Lightmap& map) { return (map.direct + map.indirect).col(0).cast<double>(); }

// H = E / (1 - rho) in a closed room of one material, also in the margins around charts.
TEST(Lightmap, OfAFurnaceIsTheSameEverywhere) {
  const Scene scene = with_box(empty_scene({grey(0.5, 3)}), Point(0, 0, 0), Point(2, 1, 1), true);
  const Lightmap map = bake_lightmap(solved_with_edge(scene, 0.125), {.texel = 0.25});
  ASSERT_EQ(map.charts.size(), 6U);
  for (const LightmapChart& chart : map.charts) {
    for (int y = chart.top - 2; y < chart.top + chart.height + 2; ++y) {
      for (int x = chart.left - 2; x < chart.left + chart.width + 2; ++x) {
        const Eigen::Index texel = static_cast<Eigen::Index>(y) * map.width + x;
        // Half a percent for the form factors of the solution.
        EXPECT_NEAR(map.direct(texel, 0) + map.indirect(texel, 0), 6, 0.03);
        EXPECT_NEAR(map.radiance(texel, 0), 6 / std::numbers::pi, 0.03 / std::numbers::pi);
      }
    }
  }
}

// The mean over texels times the area equals the flux that the solution has on a patch. The patches of the room are
// whole texels.
TEST(Lightmap, HasTheFluxOfTheSolution) {
  Scene scene = empty_scene({grey(0.5), grey(0, 40)});
  for (const Quad& face : box_faces(Point(0, 0, 0), Point(2, 1.5, 1), true)) scene = with_quad(std::move(scene), face);
  scene = with_quad(std::move(scene),
                    {Point(0.75, 0.5, 0.75), Point(0.75, 1, 0.75), Point(1.25, 1, 0.75), Point(1.25, 0.5, 0.75)}, 1);
  const Simulation simulation = solved_with_edge(scene, 0.0625);
  const Lightmap map = bake_lightmap(simulation, {.texel = 0.03125});
  ASSERT_EQ(map.texel, 0.03125);
  const Eigen::ArrayXd irradiance = irradiance_of(map);
  std::map<PatchIndex, std::pair<double, int>> sums;
  for (std::size_t texel = 0; texel < map.patch.size(); ++texel) {
    if (map.patch[texel] == no_patch) continue;
    auto& [sum, count] = sums[map.patch[texel]];
    sum += irradiance[static_cast<Eigen::Index>(texel)];
    ++count;
  }
  ASSERT_EQ(sums.size(), simulation.mesh.size());
  double worst = 0, mean_square = 0, flux = 0, solved_flux = 0;
  for (const auto& [patch, sum] : sums) {
    ASSERT_EQ(sum.second, 4);
    const double solved = simulation.solution.irradiance(patch, 0);
    const double deviation = sum.first / sum.second / solved - 1;
    worst = std::max(worst, std::abs(deviation));
    mean_square += deviation * deviation / static_cast<double>(sums.size());
    flux += sum.first / sum.second * simulation.mesh.area[patch];
    solved_flux += solved * simulation.mesh.area[patch];
  }
  EXPECT_LT(std::sqrt(mean_square), 0.01);
  EXPECT_NEAR(flux / solved_flux, 1, 0.002);
}

double interpolated(const Lightmap& map, const LightmapChart& chart, const Point& point) {
  // Texel centers are at half-integers.
  const double x = chart.left + chart.right.dot(point - chart.corner) / chart.texel[0] - 0.5;
  const double y = chart.top + chart.down.dot(point - chart.corner) / chart.texel[1] - 0.5;
  const auto left = static_cast<Eigen::Index>(std::floor(x)), top = static_cast<Eigen::Index>(std::floor(y));
  const double u = x - static_cast<double>(left), v = y - static_cast<double>(top);
  const auto at = [&](Eigen::Index column, Eigen::Index row) {
    const Eigen::Index texel = row * map.width + column;
    return static_cast<double>(map.direct(texel, 0) + map.indirect(texel, 0));
  };
  return (1 - v) * ((1 - u) * at(left, top) + u * at(left + 1, top)) +
         v * ((1 - u) * at(left, top + 1) + u * at(left + 1, top + 1));
}

// A floor of two materials with equal reflectance that meet at x = 2.37 m.
constexpr double seam = 2.37;

Scene room_with_two_floors() {
  Scene scene = furnished_room(0.5);
  scene.materials.push_back(grey(0.5));
  scene.polygons.erase(scene.polygons.begin());  // the floor
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(seam, 0, 0), Point(seam, 3, 0), Point(0, 3, 0)}, 0);
  return with_quad(std::move(scene), {Point(seam, 0, 0), Point(4, 0, 0), Point(4, 3, 0), Point(seam, 3, 0)}, 2);
}

LightmapChart chart_on_floor(const Lightmap& map, const PatchMesh& mesh, MaterialIndex material) {
  for (const LightmapChart& chart : map.charts) {
    const PatchIndex patch = chart.patches.front();
    if (mesh.material[patch] == material && mesh.centroid[patch].z() == 0) return chart;
  }
  ADD_FAILURE() << "no chart";
  return {};
}

// The mean error bar of the patches at the seam.
double bar_at_seam(const Simulation& simulation) {
  double bar = 0;
  int patches = 0;
  const Field bars = simulation.error_bars->total();
  for (PatchIndex patch = 0; patch < simulation.mesh.size(); ++patch) {
    const Point& middle = simulation.mesh.centroid[patch];
    if (middle.z() != 0 || std::abs(middle.x() - seam) > 0.25) continue;
    bar += bars(patch, 0);
    ++patches;
  }
  return bar / patches;
}

// If the light is continuous, the values interpolated on both sides of a seam differ by less than the error bars there.
TEST(Lightmap, HasNoSeamBetweenCoplanarCharts) {
  const Scene scene = room_with_two_floors();
  const Simulation simulation = solved_with_edge(scene, 0.25, true);
  const Lightmap map = bake_lightmap(simulation, {.texel = 0.1});
  const LightmapChart left = chart_on_floor(map, simulation.mesh, 0), right = chart_on_floor(map, simulation.mesh, 2);
  double mean_square = 0, worst = 0;
  constexpr int places = 200;
  for (int k = 0; k < places; ++k) {
    const Point point(seam, 0.05 + 2.9 * (k + 0.5) / places, 0);
    const double step = interpolated(map, left, point) - interpolated(map, right, point);
    mean_square += step * step / places;
    worst = std::max(worst, std::abs(step));
  }
  const double bar = bar_at_seam(simulation);
  EXPECT_GT(bar, 0);
  EXPECT_LT(std::sqrt(mean_square), bar);
  EXPECT_LT(worst, 3 * bar);
}

// The area behind a wall without thickness on the seam is dark, up to the wall.
TEST(Lightmap, LeaksNothingUnderAWallOnASeam) {
  Scene scene = room_with_two_floors();
  scene =
      with_quad(std::move(scene), {Point(seam, 0, 0), Point(seam, 3, 0), Point(seam, 3, 2.5), Point(seam, 0, 2.5)}, 0);
  const Simulation simulation = solved_with_edge(scene, 0.25);
  const Lightmap map = bake_lightmap(simulation, {.texel = 0.1});
  const LightmapChart dark = chart_on_floor(map, simulation.mesh, 0), lit = chart_on_floor(map, simulation.mesh, 2);
  const Point point(seam, 1.5, 0);
  EXPECT_GT(interpolated(map, lit, point), 0.1);
  EXPECT_EQ(interpolated(map, dark, point), 0);
}

// The area under a solid wall in the middle of a chart is dark, and interpolation must not spread it to visible texels.
TEST(Lightmap, IsNotDarkBesideAWallInTheMiddleOfAChart) {
  const Scene scene = with_box(furnished_room(0.5), Point(1.98, 0.4, 0), Point(2.17, 2.6, 1.2), false);
  Request request;
  request.mesh.max_edge = 0.25;
  request.mesh.contact_lines = false;
  const Simulation simulation = simulate(scene, request);
  const Lightmap map = bake_lightmap(simulation, {.texel = 0.05});
  const LightmapChart floor = chart_on_floor(map, simulation.mesh, 0);
  for (const double y : {0.8, 1.2, 1.8, 2.2}) {
    for (const auto& [foot, away] : {std::pair{1.98, 1.88}, std::pair{2.17, 2.27}}) {
      const double beside = interpolated(map, floor, Point(away, y, 0));
      EXPECT_GT(beside, 0);
      EXPECT_GT(interpolated(map, floor, Point(foot, y, 0)), 0.75 * beside) << foot << ", " << y;
    }
  }
}

TEST(Lightmap, HasTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = furnished_room(0.5);
  const Simulation simulation = solved_with_edge(scene, 0.5);
  std::vector<Lightmap> maps;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    maps.push_back(bake_lightmap(simulation, {.texel = 0.25}));
  }
  EXPECT_EQ(maps[0].patch, maps[1].patch);
  EXPECT_TRUE((maps[0].direct == maps[1].direct).all());
  EXPECT_TRUE((maps[0].indirect == maps[1].indirect).all());
  EXPECT_TRUE((maps[0].radiance == maps[1].radiance).all());
}

// A chart narrower than a quarter of a texel still has light.
TEST(Lightmap, OfASliverIsNotBlack) {
  Scene scene = with_box(empty_scene({grey(0.5, 3)}), Point(0, 0, 0), Point(2, 1, 1), true);
  scene = with_box(std::move(scene), Point(0.5, 0.5, 0.3), Point(1.5, 0.51, 0.6), false);
  const Lightmap map = bake_lightmap(solved_with_edge(scene, 0.25), {.texel = 0.25});
  EXPECT_EQ(map.charts.size(), 12U);
  for (const LightmapChart& chart : map.charts) {
    for (int y = chart.top; y < chart.top + chart.height; ++y) {
      for (int x = chart.left; x < chart.left + chart.width; ++x)
        EXPECT_GT(map.indirect(static_cast<Eigen::Index>(y) * map.width + x, 0), 0);
    }
  }
}

}  // namespace
}  // namespace patchlight::lightmap_test
