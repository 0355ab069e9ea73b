// Faces closer to each other than patches are wide. Light that leaks into the gap, or through it, must agree with path
// tracing or lie within the error bars.
#include "patchlight/simulate.h"

#include "support/scenes.h"
#include "verify/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::gaps_test {
namespace {

using namespace test;

// A room with a lamp under its ceiling, seven polygons in all; further polygons belong to the objects in it.
Scene room() {
  Scene scene = with_box(empty_scene({grey(0.6), grey(0, 10)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  return with_quad(std::move(scene), {Point(1.5, 1, 2.4), Point(1.5, 2, 2.4), Point(2.5, 2, 2.4), Point(2.5, 1, 2.4)},
                   1);
}

Scene room_with(const std::vector<Quad>& faces) {
  Scene scene = room();
  for (const Quad& face : faces) scene = with_quad(std::move(scene), face);
  return scene;
}

// A box at a given height above the floor, and one without a bottom. Light that passes under its rim gets inside.
std::vector<Quad> box_above(double height) {
  const auto faces = box_faces(Point(1.1, 0.9, height), Point(2.3, 1.7, height + 1), false);
  return {faces.begin(), faces.end()};
}

std::vector<Quad> open_box_above(double height) {
  const auto all = box_faces(Point(1.1, 0.9, height), Point(1.6, 1.3, height + 1), false);
  std::vector<Quad> faces(all.begin(), all.end());
  std::erase_if(faces, [&](const Quad& face) {
    return std::all_of(face.begin(), face.end(), [&](const Point& corner) { return corner.z() == height; });
  });
  return faces;
}

// A board in front of a wall.
std::vector<Quad> board_before_wall() {
  const auto faces = box_faces(Point(0.01, 0.8, 0.5), Point(0.04, 2.1, 1.9), false);
  return {faces.begin(), faces.end()};
}

// A drawer, open at its top, 1 cm below the top of a cupboard that is open toward the room.
std::vector<Quad> drawer_in_cupboard() {
  std::vector<Quad> faces;
  const auto add = [&](const Point& low, const Point& high) {
    for (const Quad& face : box_faces(low, high, false)) faces.push_back(face);
  };
  add(Point(0, 1, 0.60), Point(0.6, 2, 0.62));
  add(Point(0, 1, 0.85), Point(0.6, 2, 0.87));
  add(Point(0.05, 1.05, 0.63), Point(0.55, 1.95, 0.65));
  add(Point(0.53, 1.05, 0.65), Point(0.55, 1.95, 0.84));
  return faces;
}

// Few paths enter an open box, and the scatter of too few paths does not estimate their error.
struct Gap {
  std::string name;
  std::vector<Quad> faces;
  std::uint32_t paths = 1024;  // per patch
};

void PrintTo(const Gap& gap, std::ostream* out) { *out << gap.name; }

class Gaps : public testing::TestWithParam<Gap> {};

// A comparison over all patches of the objects in the room. The bars are standard errors: the mean of (difference /
// bar)^2 is 1, or less for wide bars. Errors of patches are correlated, so only other seeds show the uncertainty of
// this mean.
struct Compared {
  double chi_square = 0;  // mean over patches and seeds
  double scatter = 0;     // standard error of that mean, from the seeds
  double width = 0;       // of the bars, as a fraction of the light there
};

std::vector<PatchIndex> patches_in_room(const Simulation& simulation) {
  std::vector<PatchIndex> patches;
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i)
    if (simulation.mesh.polygon[i] >= 7 && simulation.transport.lost.covered[i] <= 0.5) patches.push_back(i);
  return patches;
}

PathEstimate traced(const Scene& scene, const Simulation& simulation, std::uint32_t paths) {
  std::vector<PathReceiver> receivers;
  for (const PatchIndex i : patches_in_room(simulation))
    receivers.push_back({simulation.mesh.corner_points(i).points, simulation.mesh.polygon[i], simulation.mesh.side[i]});
  return trace_irradiance(scene, kept_sides(scene, Sides::both), receivers, {.paths = paths});
}

// For one seed, without scatter.
Compared with_paths(const PathEstimate& paths, const Simulation& simulation) {
  const std::vector<PatchIndex> patches = patches_in_room(simulation);
  const Field bar = simulation.error_bars->total();
  double chi_square = 0;
  double bars = 0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double off = simulation.solution.irradiance(patches[k], 0) - paths.irradiance(row, 0);
    const double expected = std::hypot(bar(patches[k], 0), paths.standard_error(row, 0));
    bars += bar(patches[k], 0) * bar(patches[k], 0);
    if (off != 0) chi_square += std::min(off * off / (expected * expected), 1e6);
  }
  return {chi_square / static_cast<double>(patches.size()), 0, std::sqrt(bars) / paths.irradiance.matrix().norm()};
}

Compared solved_and_traced(const Gap& gap, double size, std::size_t patches, Storage storage) {
  constexpr int seeds = 4;
  const Eigen::AngleAxisd turn(size == 1 ? 0.0 : 0.7, Vector(1, 2, 3).normalized());
  const Scene scene = moved(room_with(gap.faces), Eigen::Affine3d(turn) * Eigen::Scaling(size));
  Request request;
  request.mesh.patches = patches;
  request.mesh.sides = Sides::both;
  request.assembly.storage = storage;
  if (storage == Storage::rays) request.solver.solver = Solver::gmres;
  request.accuracy.error_bars = storage == Storage::tiles;  // rows of rays always have error bars
  Compared mean;
  double squares = 0;
  PathEstimate paths;
  for (int seed = 1; seed <= seeds; ++seed) {
    request.assembly.seed = static_cast<std::uint64_t>(seed);
    const Simulation simulation = simulate(scene, request);
    if (seed == 1) paths = traced(scene, simulation, gap.paths);
    const Compared one = with_paths(paths, simulation);
    mean.chi_square += one.chi_square / seeds;
    mean.width = std::max(mean.width, one.width);
    squares += one.chi_square * one.chi_square / seeds;
  }
  mean.scatter = std::sqrt(std::max(0.0, squares - mean.chi_square * mean.chi_square) / (seeds - 1));
  return mean;
}

TEST_P(Gaps, LeakNoMoreThanBarsSay) {
  for (const double size : {1.0, 1e-3}) {
    const Compared by = solved_and_traced(GetParam(), size, 500, Storage::tiles);
    EXPECT_LT(by.chi_square, 1 + 2 * by.scatter) << "size " << size << ", scatter " << by.scatter;
    EXPECT_LT(by.width, 0.2) << "bars that tell nothing, size " << size;
  }
}

// Noise of the rays dominates these bars, so their width must match the error.
TEST_P(Gaps, LeakNoMoreThanBarsOfRaysSay) {
  for (const double size : {1.0, 1e-3}) {
    const Compared by = solved_and_traced(GetParam(), size, 2000, Storage::rays);
    EXPECT_LT(by.chi_square, 1 + 2 * by.scatter) << "size " << size << ", scatter " << by.scatter;
    EXPECT_LT(by.width, 0.2) << "bars that tell nothing, size " << size;
  }
}

// A furnace: all faces emit and reflect alike. The light is exact however flat the space is, and the bars must be
// narrow.
TEST(FlatSpaces, FurnacesHaveNarrowBars) {
  for (const double size : {1.0, 1e-3}) {
    for (const Storage storage : {Storage::tiles, Storage::rays}) {
      const Scene scene = with_box(empty_scene({grey(0.7, 0.3)}), Point(0, 0, 0), size * Point(20, 20, 0.002), true);
      Request request;
      request.mesh.patches = 500;
      request.assembly.storage = storage;
      if (storage == Storage::rays) request.solver.solver = Solver::gmres;
      request.accuracy.error_bars = storage == Storage::tiles;
      const Simulation simulation = simulate(scene, request);
      const Field& H = simulation.solution.irradiance;
      const double off = (H - 1).abs().maxCoeff();  // B = E + rho B, H = B = 0.3 / (1 - 0.7)
      EXPECT_LT(off, 1e-5) << "size " << size;
      EXPECT_LT(simulation.accuracy.back().total, 1e-3) << "size " << size;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(HardCases, Gaps,
                         testing::Values(Gap{"Box1mm", box_above(0.001)}, Gap{"Box5mm", box_above(0.005)},
                                         Gap{"Box2cm", box_above(0.02)},
                                         Gap{"OpenBox1mm", open_box_above(0.001), 16384},
                                         Gap{"OpenBox5mm", open_box_above(0.005), 16384},
                                         Gap{"OpenBox2cm", open_box_above(0.02), 16384},
                                         Gap{"Board", board_before_wall()}, Gap{"Drawer", drawer_in_cupboard()}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace patchlight::gaps_test
