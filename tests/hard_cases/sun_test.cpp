#include "lighting/direct_irradiance.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tuple>

namespace patchlight::sun_test {
namespace {

using namespace test;

// A closed box of 4 x 5 x 3 m with a square hole in its roof, which consists of four rectangles.
Scene box_with_hole(double edge) {
  Scene scene = empty_scene({grey(0.5)});
  const std::vector<Quad> faces = box_faces(Point(0, 0, 0), Point(4, 5, 3), true);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (k != 1) scene = with_quad(std::move(scene), faces[k]);
  }
  const double x = 1.234;
  const double y = 2.345;
  const auto on_roof = [&](double x0, double x1, double y0, double y1) {
    scene = with_quad(std::move(scene), {Point(x0, y0, 3), Point(x0, y1, 3), Point(x1, y1, 3), Point(x1, y0, 3)});
  };
  on_roof(0, x, 0, 5);
  on_roof(x + edge, 4, 0, 5);
  on_roof(x, x + edge, 0, y);
  on_roof(x, x + edge, y + edge, 5);
  scene.sun = Sun{Vector(0.2, 0.3, 0.9).normalized(), Spectrum::Constant(1, 10)};
  return scene;
}

// Edge of the hole in m; length of a unit; turned or not.
class SunThroughASmallHole : public testing::TestWithParam<std::tuple<double, double, bool>> {};

TEST_P(SunThroughASmallHole, IsTheFluxThatEnters) {
  // Flux = irradiance x area of the hole x cosine, up to rounding, for any seed: shadows are computed by geometry. Rays
  // from the patches would rarely hit a hole of 2 cm.
  const auto [edge, unit, turned] = GetParam();
  Eigen::Affine3d motion = Eigen::Affine3d::Identity();
  if (turned) motion.rotate(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  motion.scale(unit);
  Scene scene = moved(box_with_hole(edge), motion);
  scene.up = motion.rotation() * scene.up;
  scene.sun->direction = motion.rotation() * scene.sun->direction;
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.5 * unit);
  const double expected = 10 * edge * edge * unit * unit * 0.9 / std::sqrt(0.94);
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), mesh, {.seed = seed});
    double flux = 0;
    for (PatchIndex i = 0; i < mesh.size(); ++i) flux += mesh.area[i] * direct.irradiance(i, 0);
    EXPECT_NEAR(flux, expected, 1e-9 * expected);
    EXPECT_EQ(direct.standard_error.maxCoeff(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(HardCases, SunThroughASmallHole,
                         testing::Combine(testing::Values(0.02, 0.2), testing::Values(1.0, 0.001, 1000.0),
                                          testing::Bool()));

}  // namespace
}  // namespace patchlight::sun_test
