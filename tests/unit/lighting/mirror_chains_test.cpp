#include "lighting/mirror_chains.h"

#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <utility>

namespace patchlight::mirror_chains_test {
namespace {

using namespace test;

Material mirror(double specular_reflectance) {
  Material material = grey(0);
  material.specular_reflectance = Spectrum::Constant(1, specular_reflectance);
  return material;
}

Scene with_square(Scene scene, const Point& corner, double edge, MaterialIndex material) {
  const Vector x = edge * Vector::UnitX(), y = edge * Vector::UnitY();
  return with_quad(std::move(scene), {corner, Point(corner + x), Point(corner + x + y), Point(corner + y)}, material);
}

// A mirror of 10 x 10 m on the ground, and one of 2 cm, 10 cm below a luminaire at 2 m, that looks up at it.
Scene large_mirror_and_reflector() {
  Scene scene = empty_scene({mirror(0.9), grey(0.5)});
  scene = with_square(std::move(scene), Point(-5, -5, 0), 10, 0);
  scene = with_square(std::move(scene), Point(-0.01, -0.01, 1.9), 0.02, 0);
  scene = with_square(std::move(scene), Point(-5, -5, 4), 10, 1);
  Luminaire lamp;
  lamp.position = Point(0, 0, 2);
  lamp.light = PointLight{Spectrum::Constant(1, 1.0)};
  scene.luminaires = {lamp};
  return scene;
}

TEST(MirrorChains, SmallMirrorsBesideALampAreFollowed) {
  // By area it is 4e-6 of the large one; of the lamp's light it meets A / (4 pi d^2) = 3.2e-3, which is 8e-3 of what
  // may meet the other by its area.
  const Scene scene = large_mirror_and_reflector();
  const MirrorChains found = mirror_chains(scene);
  ASSERT_GE(found.chains.size(), 2U);
  EXPECT_EQ(found.chains[0].mirrors[0].polygon, 0U);
  const bool follows = std::any_of(found.chains.begin(), found.chains.end(), [](const MirrorChain& chain) {
    return chain.mirrors.size() == 1 && chain.mirrors[0].polygon == 1 && chain.mirrors[0].side == Side::front;
  });
  EXPECT_TRUE(follows);
  // Its back is not, by its area.
  EXPECT_NEAR(found.left_out, 4e-6, 1e-7);
  EXPECT_FALSE(found.is_cut);
}

TEST(MirrorChains, WhatIsSmallAndFarFromLampsIsLeftOutAndTold) {
  Scene scene = large_mirror_and_reflector();
  scene.luminaires.clear();
  const MirrorChains found = mirror_chains(scene);
  for (const MirrorChain& chain : found.chains) EXPECT_NE(chain.mirrors[0].polygon, 1U);
  // Both of its sides, by area.
  EXPECT_NEAR(found.left_out, 8e-6, 1e-7);
}

TEST(MirrorChains, MoreWaysThanAreFollowedAreTold) {
  // Two rows of facets that face each other: of 24 x 24 pairs there are 1,152 ways over two mirrors, in either order.
  Scene scene = empty_scene({mirror(0.9)});
  for (int k = 0; k < 24; ++k) {
    scene = with_square(std::move(scene), Point(k, 0, 0), 0.9, 0);
    scene =
        with_quad(std::move(scene), {Point(k, 0, 3), Point(k, 0.9, 3), Point(k + 0.9, 0.9, 3), Point(k + 0.9, 0, 3)});
  }
  const MirrorChains found = mirror_chains(scene);
  EXPECT_EQ(found.chains.size(), 1024U);
  EXPECT_TRUE(found.is_cut);
}

}  // namespace
}  // namespace patchlight::mirror_chains_test
