#include "quad_scene.h"
#include "render/render.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::ambient_occlusion_test {
namespace {

// A floor patch of this width with its low edge at x, beside a practically infinite wall at x = 0.
Scene corner(double x, double width) {
  return quad_scene({{Point(x, 0, 0), Point(x + width, 0, 0), Point(x + width, width, 0), Point(x, width, 0)},
                     {Point(0, -20, 0), Point(0, 20, 0), Point(0, 20, 20), Point(0, -20, 20)}});
}

TEST(AmbientOcclusion, BesideAWallIsThatOfACircularSegment) {
  // A wall hides the directions within a distance d whose sine towards it is above c = x / d. Projected onto the unit
  // disc (Nusselt) that is the segment beyond c: its area is acos c - c sqrt(1 - c^2), of pi.
  constexpr double distance = 2;
  for (const double x : {0.1, 0.5, 1.2, 1.9, 2.5}) {
    const Scene scene = corner(x - 0.005, 0.01);
    const double found =
        ambient_occlusion(front_patches(scene), Occluder(scene, Occluder::Blockers::all), distance, 4096)[0];
    const double c = std::min(1.0, x / distance);
    // Owen-scrambled points in the plane: n^-3/4 for the outline of a region, with a constant of about 1.
    EXPECT_NEAR(found, 1 - (std::acos(c) - c * std::sqrt(1 - c * c)) / std::numbers::pi, std::pow(4096, -0.75)) << x;
  }
}

TEST(AmbientOcclusion, IsNothingInASmallClosedBoxAndAllBeforeTheSky) {
  const Scene box = quad_scene(inner_sides({0, 0, 0}, {1, 1, 1}));
  const Occluder occluder(box, Occluder::Blockers::all);
  EXPECT_EQ(ambient_occlusion(front_patches(box), occluder, 2).maxCoeff(), 0);
  // Within a very small distance of the middle of a patch nearly all directions are free.
  EXPECT_GT(ambient_occlusion(front_patches(box), occluder, 1e-3).minCoeff(), 0.99);
  const Scene floor = quad_scene({{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)}});
  EXPECT_EQ(ambient_occlusion(front_patches(floor), Occluder(floor, Occluder::Blockers::all), 5)[0], 1);
}

TEST(AmbientOcclusion, PictureOfALonelyFaceIsItsReflectance) {
  const Scene floor = quad_scene({{Point(-9, -9, 0), Point(9, -9, 0), Point(9, 9, 0), Point(-9, 9, 0)}});
  const Lens lens({Point(0, 0, 1), Point(0, 0, 0), 40}, Vector::UnitY(), 8, 8);
  const Image image = ambient_image(floor, Occluder(floor, Occluder::Blockers::all), lens, 8, 8, 1);
  EXPECT_NEAR((image.pixels - 0.5).abs().maxCoeff(), 0, 1e-12);
}

}  // namespace
}  // namespace patchlight::ambient_occlusion_test
