// The mean estimate of an exchange area over many pairs and seeds is the true one for any size of the opening.
#include "patchlight/transport/assemble.h"

#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::visible_share_test {
namespace {

using namespace test;

// Unit squares 10 m apart. Strips halfway between them leave 20 slits per meter, with the fraction `open`. There are so
// many strips that no ray passes beside them.
Scene barred_squares(double open) {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 10), Point(0, 1, 10), Point(1, 1, 10), Point(1, 0, 10)});
  const double pitch = 0.05;
  for (int k = -1; k <= 20; ++k) {
    const double begin = (k + open) * pitch;
    const double end = (k + 1) * pitch;
    scene = with_quad(std::move(scene), {Point(begin, -1, 5), Point(end, -1, 5), Point(end, 2, 5), Point(begin, 2, 5)});
  }
  return scene;
}

Scene unbarred_squares() {
  Scene scene = barred_squares(0.5);
  scene.polygons.resize(2);
  return scene;
}

// Exchange area of the first two polygons, m^2, with 64 patches each. The others are obstacles without patches.
double exchanged(const Scene& scene, double max_edge, const AssemblyOptions& options) {
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 0);
  kept.back.assign(scene.polygons.size(), 0);
  kept.front[0] = kept.front[1] = 1;
  const PatchMesh mesh = tessellate(scene, kept, max_edge);
  EXPECT_EQ(mesh.size(), 128U);
  return row_sums(assemble_exchange_areas(mesh, Occluder(scene), options).exchange_areas).sum() / 2;
}

// A ray between uniform points of the squares crosses the strips at the mean of two uniform coordinates. Its
// characteristic function is sinc^2, which vanishes at every whole period in 0.5 m. So the fraction that passes is
// `open` to the last digit, apart from the geometry term. That varies by 2 % over meters, not over slits. 4096 pairs
// have form factors of 5e-5, so each has 16 rays.
TEST(VisibleShare, HasTheRightExpectation) {
  constexpr int seeds = 16;
  const double whole = exchanged(unbarred_squares(), 0.1251, {});
  for (const double open : {0.02, 0.1, 0.5, 0.98}) {
    for (const double size : {1.0, 1e-3}) {
      const Eigen::AngleAxisd turn(size == 1 ? 0.0 : 0.7, Vector(1, 2, 3).normalized());
      const Eigen::Affine3d motion = Eigen::Affine3d(turn) * Eigen::Scaling(size);
      const Scene scene = moved(barred_squares(open), motion);
      double sum = 0;
      double squares = 0;
      for (int seed = 1; seed <= seeds; ++seed) {
        const double share =
            exchanged(scene, 0.1251 * size, {.samples = 16, .seed = static_cast<std::uint64_t>(seed)}) /
            (whole * size * size);
        sum += share;
        squares += share * share;
      }
      const double mean = sum / seeds;
      const double standard_error = std::sqrt(std::max(0.0, squares / seeds - mean * mean) / (seeds - 1));
      EXPECT_NEAR(mean, open, 3 * standard_error + 1e-4) << "size " << size;
      // Independent rays: sqrt((1 - p) / (p n)) with n = 16 x 4096 x 16. Stratified rays are no worse. 16 seeds
      // estimate a standard error to a sixth.
      EXPECT_LT(standard_error, 1.5 * std::sqrt(open * (1 - open) / (16.0 * 4096 * seeds))) << "size " << size;
    }
  }
}

}  // namespace
}  // namespace patchlight::visible_share_test
