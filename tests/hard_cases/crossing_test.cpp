// Patches that lie on both sides of a wall, alike in all quarters, carry light through it, and bars say so.
#include "patchlight/simulate.h"

#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>

namespace patchlight::crossing_test {
namespace {

using namespace test;

constexpr PolygonIndex of_room_and_pipe = 13;

// A room with a lamp under its ceiling, a pipe through it, and two dark boxes without openings around that, each in the
// middle of half of the pipe.
Scene room_with_pipe() {
  Scene scene = with_box(empty_scene({grey(0.7), grey(0, 10)}), Point(0, 0, 0), Point(3, 2, 2), true);
  scene =
      with_quad(std::move(scene), {Point(1, 0.5, 1.9), Point(1, 1.5, 1.9), Point(2, 1.5, 1.9), Point(2, 0.5, 1.9)}, 1);
  scene = with_box(std::move(scene), Point(0, 0.95, 0.95), Point(3, 1.05, 1.05), false);
  for (const double from : {0.5, 2.0})
    scene = with_box(std::move(scene), Point(from, 0.75, 0.75), Point(from + 0.5, 1.25, 1.25), false);
  return scene;
}

// No light at all gets into the boxes: what is found there is the error.
TEST(Crossing, IsInTheBarsOfWhatItLights) {
  Request request;
  request.mesh.max_edge = 1.5;
  request.mesh.sides = Sides::both;
  request.mesh.contact_lines = false;
  request.assembly.storage = Storage::rays;
  request.solver.solver = Solver::gmres;
  request.accuracy.local_cuts = false;
  const Simulation simulation = simulate(room_with_pipe(), request);
  const PatchMesh& mesh = simulation.mesh;
  const Field bar = simulation.error_bars->total();
  double in_room = 0;
  double found = 0;
  double stated = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const double irradiance = simulation.solution.irradiance(i, 0);
    if (mesh.polygon[i] < 6) in_room = std::max(in_room, irradiance);
    // Backs of boxes look inwards.
    if (mesh.polygon[i] < of_room_and_pipe || mesh.side[i] != Side::back) continue;
    found += mesh.area[i] * irradiance * irradiance;
    stated += mesh.area[i] * bar(i, 0) * bar(i, 0);
  }
  EXPECT_GT(std::sqrt(found), 0.01 * in_room) << "nothing gets in";
  EXPECT_GT(std::sqrt(stated), 0.5 * std::sqrt(found));
  EXPECT_LT(std::sqrt(stated), 2 * std::sqrt(found));
}

}  // namespace
}  // namespace patchlight::crossing_test
