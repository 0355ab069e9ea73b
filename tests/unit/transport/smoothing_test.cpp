#include "transport/smoothing.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::smoothing_test {
namespace {

using namespace test;

// A floor of 2 x 2 m and a wall of 2 x 2 m on its edge.
PatchMesh floor_and_wall() {
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  scene = with_quad(std::move(scene), {Point(0, 2, 0), Point(2, 2, 0), Point(2, 2, 2), Point(0, 2, 2)});
  return tessellate(scene, kept_sides(scene, Sides::front), 0.1);
}

Field column(const PatchMesh& mesh, const auto& value_at) {
  Field field(mesh.size(), 1);
  for (PatchIndex i = 0; i < mesh.size(); ++i) field(i, 0) = value_at(i);
  return field;
}

const std::vector<float> far_away(const PatchMesh& mesh) { return std::vector<float>(mesh.size(), 2); }

TEST(Smoothing, LeavesAConstantAsItIsAndCarriesNothingAcrossAnEdge) {
  const PatchMesh mesh = floor_and_wall();
  const Field field = column(mesh, [&](PatchIndex i) { return mesh.polygon[i] == 0 ? 1.0 : 5.0; });
  const SmoothedHalves smooth = smoothed(mesh, far_away(mesh), {field, field});
  EXPECT_LT((smooth.halves[0] - field).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(smooth.variance.maxCoeff(), 0);
}

// Where neighbors lie on all sides, moments of odd order vanish and slopes have no effect.
TEST(Smoothing, LeavesALinearFieldAsItIsInsideAFace) {
  const PatchMesh mesh = floor_and_wall();
  const Field field = column(mesh, [&](PatchIndex i) { return 1 + mesh.centroid[i].x() + 2 * mesh.centroid[i].y(); });
  const SmoothedHalves smooth = smoothed(mesh, far_away(mesh), {field, field});
  int inside = 0;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const Point& c = mesh.centroid[i];
    if (mesh.polygon[i] != 0 || c.head<2>().minCoeff() < 0.42 || c.head<2>().maxCoeff() > 1.58) continue;
    EXPECT_NEAR(smooth.halves[0](i, 0), field(i, 0), 1e-9);
    ++inside;
  }
  EXPECT_GT(inside, 50);
}

// Noise of variance 1/12 in each half: the mean of both has 1/24, and the stated variance is the rest after smoothing.
TEST(Smoothing, StatesTheVarianceThatIsLeft) {
  const PatchMesh mesh = floor_and_wall();
  const auto noise = [&](std::uint64_t half) {
    return column(mesh, [half](PatchIndex i) { return 3 + hash({half, i}) * 0x1p-32 - 0.5; });
  };
  const SmoothedHalves smooth = smoothed(mesh, far_away(mesh), {noise(1), noise(2)});
  const Field error = 0.5 * (smooth.halves[0] + smooth.halves[1]) - 3;
  EXPECT_LT(error.square().mean(), 1.0 / 24 / 8);
  // About 800 / 30 independent values: the ratio of the roots scatters by about 14 %.
  EXPECT_NEAR(std::sqrt(smooth.variance.mean() / error.square().mean()), 1, 0.35);
}

// Patches under a close object keep their value.
TEST(Smoothing, KeepsToTheRadiusOfWhatIsNear) {
  const PatchMesh mesh = floor_and_wall();
  const Field field = column(mesh, [](PatchIndex i) { return std::abs(std::sin(3.0 * i)); });
  std::vector<float> near(mesh.size(), 2);
  for (PatchIndex i = 0; i < mesh.size(); i += 2) near[i] = 0.3F;
  const SmoothedHalves smooth = smoothed(mesh, near, {field, field});
  for (PatchIndex i = 0; i < mesh.size(); i += 2) EXPECT_EQ(smooth.halves[1](i, 0), field(i, 0));
}

// The inside of a sheet 1 mm thick is dark. The outside, with the same orientation, is bright. Both halves show the
// difference, at any distance for means.
TEST(Smoothing, CarriesNothingIntoASpaceBehindAFace) {
  Scene scene = empty_scene({grey(0.5)});
  for (const double z : {0.0, 0.001})
    scene = with_quad(std::move(scene), {Point(0, 0, z), Point(2, 0, z), Point(2, 2, z), Point(0, 2, z)});
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.1);
  const auto irradiance = [&](std::uint64_t half) {
    return column(mesh, [&](PatchIndex i) { return mesh.polygon[i] == 0 ? 0 : 100 + hash({half, i}) * 0x1p-32; });
  };
  const SmoothedHalves smooth = smoothed(mesh, far_away(mesh), {irradiance(1), irradiance(2)});
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const double low = mesh.polygon[i] == 0 ? 0 : 100;
    EXPECT_GE(smooth.halves[0](i, 0), low);
    EXPECT_LE(smooth.halves[0](i, 0), low == 0 ? 0 : 101);
    EXPECT_LT(smooth.variance(i, 0), 1);
  }
}

TEST(Smoothing, HasTheSameBitsForAnyNumberOfThreads) {
  const PatchMesh mesh = floor_and_wall();
  const Field field = column(mesh, [](PatchIndex i) { return std::abs(std::sin(3.0 * i)); });
  const auto found = [&](int threads) {
    const ThreadLimit limit(threads);
    return smoothed(mesh, far_away(mesh), {field, field.square()});
  };
  EXPECT_TRUE((found(1).halves[1] == found(2).halves[1]).all());
  EXPECT_TRUE((found(1).variance == found(2).variance).all());
}

// Bands that are powers of two times one of them, in which the same patches differ, to the bit. Patches have near and
// far search radii, so that cells of several sizes are used.
TEST(Smoothing, TreatsAllBandsAlike) {
  constexpr Eigen::Index bands = 6;
  const PatchMesh mesh = floor_and_wall();
  std::vector<float> distance;
  for (PatchIndex i = 0; i < mesh.size(); ++i) distance.push_back(i % 3 == 0 ? 1.0F : 3.0F);
  const auto noisy = [&](std::uint32_t seed) {
    return column(mesh, [&](PatchIndex i) { return 2 + 0.1 * (hash({seed, i}) * 0x1p-32 - 0.5); });
  };
  const std::array<Field, 2> one{noisy(1), noisy(2)};
  const auto in_bands = [&](const Field& field, double base) {
    Field all(field.rows(), bands);
    for (Eigen::Index band = 0; band < bands; ++band) all.col(band) = std::pow(base, band) * field.col(0);
    return all;
  };
  const SmoothedHalves alone = smoothed(mesh, distance, one);
  const SmoothedHalves together = smoothed(mesh, distance, {in_bands(one[0], 2), in_bands(one[1], 2)});
  for (std::size_t half = 0; half < 2; ++half)
    EXPECT_TRUE((together.halves[half] == in_bands(alone.halves[half], 2)).all());
  EXPECT_TRUE((together.variance == in_bands(alone.variance, 4)).all());
  EXPECT_GT((alone.halves[0] - one[0]).abs().maxCoeff(), 0.01) << "they are smoothed";
}

}  // namespace
}  // namespace patchlight::smoothing_test
