// Decisions about a scene hold on each of its meshes.
#include "patchlight/simulate.h"

#include "support/effect_scenes.h"

#include <cstddef>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::decisions_test {
namespace {

using namespace test;

// Facts about a mesh before closure.
struct LookedAt {
  std::size_t shadow_rays = 0;
  bool direct_light = false;
};

std::vector<LookedAt> looked_at(const Scene& scene, Request request) {
  request.accuracy.relative_error = 0.01;
  request.mesh.patches = 100;
  std::vector<LookedAt> meshes;
  simulate(
      scene, request, {}, {.look = [&meshes](const Simulation& simulation) {
        meshes.push_back({simulation.transport.counts.shadow_rays, simulation.problem.direct_irradiance.size() > 0});
      }});
  return meshes;
}

TEST(Decisions, HoldOnEveryMeshOnTheWayToAnAccuracy) {
  Request request;
  request.mesh.sides = Sides::front;
  const Scene scene = with_point_light(lit_box(0.5), Spectrum::Constant(1, 5));
  const std::vector<LookedAt> planned = looked_at(scene, request);
  const std::vector<LookedAt> overruled =
      looked_at(scene, forcing(Effect::occlusion, skipping(Effect::luminaires, request)));
  EXPECT_GT(planned.size(), 1U) << "the first mesh alone shows nothing";
  EXPECT_GT(overruled.size(), 1U);
  for (const LookedAt& mesh : planned) {
    EXPECT_EQ(mesh.shadow_rays, 0U);
    EXPECT_TRUE(mesh.direct_light);
  }
  for (const LookedAt& mesh : overruled) {
    EXPECT_GT(mesh.shadow_rays, 0U);
    EXPECT_FALSE(mesh.direct_light);
  }
}

// Error bars need the matrix even if the rows of the lamps would suffice for the light.
TEST(Decisions, BlackRoomsHaveErrorBars) {
  Request request = coarse();
  request.accuracy.error_bars = true;
  const Simulation black = simulate(furnished_room(0), request);
  EXPECT_FALSE(decision(black, Effect::interreflection).simulate);
  ASSERT_TRUE(black.error_bars);
  EXPECT_TRUE(black.error_bars->total().isFinite().all());
  EXPECT_EQ(black.accuracy.back().total, 0) << "nothing is reflected";
}

}  // namespace
}  // namespace patchlight::decisions_test
