// Laws of local refinement and of additional rays, if few patches dominate an error.
#include "patchlight/base/error.h"
#include "patchlight/simulate.h"

#include "plan/choose_storage.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::local_cuts_test {
namespace {

using namespace test;

// A room of 4 x 3 x 2.5 m under a uniform sky, one wall of which has half the height. Light reaches the space under a
// board 4 cm above the floor only from the rims.
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

// Flux on each side of each polygon in one band, W.
std::vector<double> fluxes(const Simulation& s) {
  std::vector<double> flux;
  for (PatchIndex i = 0; i < s.mesh.size(); ++i) {
    const std::size_t side = 2 * s.mesh.polygon[i] + static_cast<std::size_t>(s.mesh.side[i]);
    flux.resize(std::max(flux.size(), side + 1), 0);
    flux[side] += s.problem.area[i] * s.solution.irradiance(i, 0);
  }
  return flux;
}

// The flux on the underside of the board is a hundredth of the floor's and is blurred over patches wider than the gap.
// The reference has eight times the patches and four times the rays; the test sums over four seeds. A cut leaves 2^-1.2
// = 0.44 of such an error, or 0.7 with the noise of rays. The plan adds a quarter more patches, plus those that balance
// the mesh.
TEST(LocalCuts, TakeAwayErrorWithFewPatches) {
  const Scene scene = room_with_board();
  constexpr std::size_t underside = 2 * 6;  // the front of the board's first face
  const auto under_the_board = [](const Simulation& s) { return fluxes(s)[underside]; };
  Request fine = by_rays(false);
  fine.mesh.patches = 12000;
  fine.assembly.rays = 256;
  const double exact = under_the_board(simulate(scene, fine));
  double whole = 0;
  double cut = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Simulation before = simulate(scene, by_rays(false, seed));
    const Simulation after = simulate(scene, by_rays(true, seed));
    whole += under_the_board(before) - exact;
    cut += under_the_board(after) - exact;
    ASSERT_EQ(before.accuracy.size(), 1U);
    ASSERT_EQ(after.accuracy.size(), 2U);
    EXPECT_LT(after.accuracy[1].total, after.accuracy[0].total);
    EXPECT_LT(after.accuracy[1].total, before.accuracy[0].total);
    EXPECT_LT(after.mesh.size(), 1.5 * before.mesh.size());
  }
  EXPECT_LT(std::abs(cut), 0.7 * std::abs(whole));
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

// All flux that enters is absorbed or leaves. R rays that carry equal parts of the flux have a relative error of 1 /
// sqrt(R), less with stratification.
TEST(LocalCuts, KeepTheBalance) {
  const Simulation s = simulate(room_with_board(), by_rays(true));
  ASSERT_EQ(s.accuracy.size(), 2U);
  EXPECT_LT(s.balance.imbalance, 1 / std::sqrt(64.0 * s.mesh.size()));
}

struct Mean {
  double value = 0;
  double variance = 0;  // of the mean
};

Mean mean_of(const std::vector<double>& values) {
  Mean mean;
  const auto count = static_cast<double>(values.size());
  for (const double value : values) mean.value += value / count;
  for (const double value : values) mean.variance += std::pow(value - mean.value, 2) / (count * (count - 1));
  return mean;
}

// Light from an earlier mesh is kept if its scatter is small. This selection must not darken the room: the means over
// sixteen seeds agree within three standard errors, and these are within half a percent.
TEST(LocalCuts, LetInAsMuchLight) {
  const Scene scene = room_with_board();
  std::vector<double> cut;
  std::vector<double> whole;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    Request request = by_rays(true, seed);
    request.mesh.patches = 500;
    cut.push_back(simulate(scene, request).balance.arriving[0]);
    request.accuracy.local_cuts = false;
    whole.push_back(simulate(scene, request).balance.arriving[0]);
  }
  const Mean with = mean_of(cut);
  const Mean without = mean_of(whole);
  const double scatter = std::sqrt(with.variance + without.variance);
  EXPECT_LT(scatter, 0.005 * without.value);
  EXPECT_NEAR(with.value, without.value, 3 * scatter);
}

// A cube lit by a small lamp has an error below 2 %. The part that cuts would remove is smaller still.
TEST(LocalCuts, AreLeftOutWhereTheErrorIsSmall) {
  Request request = by_rays(true);
  request.mesh.patches = 4000;
  const Simulation s = simulate(furnished_room(0.3), request);
  EXPECT_EQ(s.accuracy.size(), 1U);
  EXPECT_LT(s.accuracy[0].total, 0.02);
  EXPECT_GT(s.accuracy[0].total, 0.005);
}

// A mesh that does not fit into memory beside the first one is not computed, and a note reports it.
TEST(LocalCuts, AreLeftOutWhereMemoryIsShort) {
  Request request = by_rays(true);
  const Simulation first = simulate(room_with_board(), request);
  ASSERT_EQ(first.accuracy.size(), 2U);
  request.resources.memory = memory_needed(*request.mesh.patches, first.plan);
  const Simulation s = simulate(room_with_board(), request);
  EXPECT_EQ(s.accuracy.size(), 1U);
  ASSERT_FALSE(s.notes.empty());
  EXPECT_EQ(s.notes.back().code, DiagnosticCode::second_mesh);
  const std::string& note = s.notes.back().text;
  EXPECT_NE(note.find("(resources.memory)"), std::string::npos) << note;
}

// A lamp between two walls of 2 x 2 m that face each other, each of a hundred mirrors.
Scene lamp_between_facets() {
  Material mirror = grey(0);
  mirror.specular_reflectance = Spectrum::Constant(1, 0.9);
  Scene scene = empty_scene({grey(0.5), mirror});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  constexpr double edge = 0.2;
  for (int k = 0; k < 100; ++k) {
    const double y = edge * (k % 10), z = edge * (k / 10);
    const Quad facet{Point(0, y, z), Point(0, y + edge, z), Point(0, y + edge, z + edge), Point(0, y, z + edge)};
    scene = with_quad(std::move(scene), facet, 1);
    Quad other{facet[3], facet[2], facet[1], facet[0]};
    for (Point& corner : other) corner.x() = 2;
    scene = with_quad(std::move(scene), other, 1);
  }
  Luminaire lamp;
  lamp.position = Point(0.7, 0.9, 1.1);
  lamp.light = PointLight{Spectrum::Constant(1, 10.0)};
  scene.luminaires = {lamp};
  return scene;
}

// More rays do not reduce the error by chains of mirrors that are too many to be followed. A second mesh would be made
// for an error of more than 2 %.
TEST(LocalCuts, AreNotMadeForLightThatIsNotFollowed) {
  Request request = by_rays(true);
  request.mesh.patches = 300;
  const Simulation s = simulate(lamp_between_facets(), request);
  ASSERT_EQ(s.accuracy.size(), 1U);
  EXPECT_GT(s.accuracy[0].form_factor, 0.025);
}

// The solver adds meshes until it reaches an accuracy. Each mesh has at most four times the patches of the last, plus a
// quarter for balance. The flux under the board is within three times the stated error, as it is a hundredth of the
// light and has a larger error than most.
TEST(LocalCuts, ReachAnAccuracy) {
  const Scene scene = room_with_board();
  constexpr std::size_t underside = 2 * 6;
  Request fine = by_rays(false);
  fine.mesh.patches = 12000;
  fine.assembly.rays = 256;
  const double exact = fluxes(simulate(scene, fine))[underside];
  Request request = by_rays(false);
  request.mesh.patches.reset();
  request.accuracy.relative_error = 0.02;
  const Simulation s = simulate(scene, request);
  ASSERT_GE(s.accuracy.size(), 3U);
  EXPECT_LE(s.accuracy.back().total, 0.02);
  for (std::size_t step = 1; step < s.accuracy.size(); ++step)
    EXPECT_LE(s.accuracy[step].patches, 4 * 1.25 * s.accuracy[step - 1].patches);
  EXPECT_GT(s.accuracy.back().samples, s.accuracy.front().samples);
  EXPECT_LT(s.accuracy.back().new_patches, s.accuracy.back().patches);
  EXPECT_NEAR(fluxes(s)[underside], exact, 3 * 0.02 * exact);
}

// A run that starts with pairs continues with rays once pairs no longer fit into memory, until it reaches the accuracy.
TEST(LocalCuts, GoOnWherePairsNoLongerFit) {
  Request request;
  request.accuracy.relative_error = 0.02;
  AssemblyOptions pairs = request.assembly;
  pairs.storage = Storage::tiles;
  request.resources.memory = memory_needed(1100, pairs, request.accuracy);
  const Simulation s = simulate(room_with_board(), request);
  EXPECT_EQ(s.plan.assembly.storage, Storage::rays);
  EXPECT_LE(s.accuracy.back().total, 0.02);
  EXPECT_LT(s.accuracy.back().new_patches, s.accuracy.back().patches);
  EXPECT_GT(s.accuracy.back().samples, s.plan.assembly.rays);
}

// On the way to an accuracy, refinement stops at the memory limit.
TEST(LocalCuts, OnTheWayToAnAccuracyKeepTheMemory) {
  Request request = by_rays(false);
  request.accuracy.relative_error = 0.002;
  const Simulation first = simulate(room_with_board(), by_rays(false));
  request.resources.memory = memory_needed(*request.mesh.patches + *request.mesh.patches / 2, first.plan);
  EXPECT_THROW(simulate(room_with_board(), request), MemoryError);
}

}  // namespace
}  // namespace patchlight::local_cuts_test
