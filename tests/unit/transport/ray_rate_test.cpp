#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/pair_sampler.h"
#include "visibility/occluder.h"

#include <gtest/gtest.h>

namespace patchlight::ray_rate_test {
namespace {

using namespace test;

// The rate depends on the machine. It is finite, and only stated if there were enough rays to time.
TEST(BareRayRate, IsStatedForEnoughRaysOnly) {
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.5);
  const Occluder occluder(scene);
  EXPECT_EQ(bare_ray_rate(mesh, occluder, 0), 0);
  EXPECT_EQ(bare_ray_rate(mesh, occluder, 1000), 0);
  const double rate = bare_ray_rate(mesh, occluder, 1U << 20);
  EXPECT_GT(rate, 1e3);
  EXPECT_LT(rate, 1e12);
}

}  // namespace
}  // namespace patchlight::ray_rate_test
