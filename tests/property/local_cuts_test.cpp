// Laws of meshes that are cut, and rays that are doubled, where few patches make most of an error.
#include "patchlight/simulate.h"

#include "plan/memory.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::local_cuts_test {
namespace {

using namespace test;

// A room of 4 x 3 x 2.5 m under an even sky, one wall of which is half as high, and a board 4 cm above its floor, under
// which light gets from the rims alone.
Scene room_with_board() {
  Scene scene = empty_scene({grey(0.7)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (const Quad& face : faces) {
    const bool is_open = std::all_of(face.begin(), face.end(), [](const Point& corner) { return corner.y() == 0; });
    if (!is_open) scene = with_quad(std::move(scene), face);
  }
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(0, 0, 1.25), Point(4, 0, 1.25), Point(4, 0, 0)});
  scene = with_box(std::move(scene), Point(1, 1, 0.04), Point(3, 2, 0.08), false);
  Sky sky;
  sky.horizontal_irradiance = Spectrum::Constant(1, 100);
  scene.sky = sky;
  return scene;
}

Request by_rays(bool is_cut, std::uint64_t seed = 1) {
  Request request;
  request.mesh.patches = 1500;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  request.assembly.seed = seed;
  request.accuracy.local_cuts = is_cut;
  return request;
}

// The flux that arrives at each side of each polygon, of one band, W.
std::vector<double> fluxes(const Simulation& s) {
  std::vector<double> flux;
  for (PatchIndex i = 0; i < s.mesh.size(); ++i) {
    const std::size_t side = 2 * s.mesh.polygon[i] + static_cast<std::size_t>(s.mesh.side[i]);
    flux.resize(std::max(flux.size(), side + 1), 0);
    flux[side] += s.problem.area[i] * s.solution.irradiance(i, 0);
  }
  return flux;
}

double squared_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::pow(a[k] - b[k], 2);
  return sum;
}

// Over four seeds, against eight times the patches with four times the rays. What is stated falls as well.
TEST(LocalCuts, TakeAwayErrorWithFewPatches) {
  const Scene scene = room_with_board();
  Request fine = by_rays(false);
  fine.mesh.patches = 12000;
  fine.assembly.rays = 256;
  const std::vector<double> exact = fluxes(simulate(scene, fine));
  double whole = 0;
  double cut = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Simulation before = simulate(scene, by_rays(false, seed));
    const Simulation after = simulate(scene, by_rays(true, seed));
    whole += squared_distance(fluxes(before), exact);
    cut += squared_distance(fluxes(after), exact);
    ASSERT_EQ(before.accuracy.size(), 1U);
    ASSERT_EQ(after.accuracy.size(), 2U);
    EXPECT_LT(after.accuracy[1].total, 0.7 * after.accuracy[0].total);
    EXPECT_LT(after.mesh.size(), 1.6 * before.mesh.size());
  }
  EXPECT_LT(cut, 0.6 * whole);
}

TEST(LocalCuts, HaveTheSameBitsForAnyNumberOfThreads) {
  Request request = by_rays(true);
  const auto solved = [&](int threads) {
    request.resources.threads = threads;
    return simulate(room_with_board(), request);
  };
  const Simulation one = solved(1);
  const Simulation two = solved(2);
  ASSERT_EQ(one.accuracy.size(), 2U);
  EXPECT_TRUE((one.solution.radiosity == two.solution.radiosity).all());
  EXPECT_TRUE((one.ray_standard_error == two.ray_standard_error).all());
}

// All flux that gets in is absorbed or leaves, as without cuts: by as many rays to about .3 %.
TEST(LocalCuts, KeepTheBalance) {
  const Simulation s = simulate(room_with_board(), by_rays(true));
  ASSERT_EQ(s.accuracy.size(), 2U);
  EXPECT_LT(s.balance.imbalance, 3e-3);
}

TEST(LocalCuts, AreLeftOutWhereTheErrorIsSmall) {
  Scene scene = cube_room(0.7, 0.3);
  scene.materials.push_back(grey(0.4, 0.6));
  scene = with_box(std::move(scene), Point(0.3, 0.3, 0.3), Point(0.6, 0.7, 0.5), false, 1);
  const Simulation s = simulate(scene, by_rays(true));
  EXPECT_EQ(s.accuracy.size(), 1U);
  EXPECT_LT((s.solution.radiosity - 1).abs().maxCoeff(), 1e-5);
}

// A mesh that does not fit beside the first one is not made.
TEST(LocalCuts, AreLeftOutWhereMemoryIsShort) {
  Request request = by_rays(true);
  const Simulation first = simulate(room_with_board(), request);
  ASSERT_EQ(first.accuracy.size(), 2U);
  request.resources.memory = memory_needed(first.accuracy[0].patches, first.plan);
  EXPECT_EQ(simulate(room_with_board(), request).accuracy.size(), 1U);
}

}  // namespace
}  // namespace patchlight::local_cuts_test
