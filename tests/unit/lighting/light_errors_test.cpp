// Standard errors of light from lamps with extent and from the sky, compared with many more samples.
#include "patchlight/scene/sides.h"

#include "lighting/direct_irradiance.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::light_errors_test {
namespace {

using namespace test;

constexpr std::uint64_t number_of_seeds = 20;

// A floor of 4 x 4 m, a plate of 1 x 1 m, 0.5 m above it, and a ball lamp of 0.2 m, 1.5 m above it. In the plate's
// shadow the visible part of the lamp varies from nothing to a small part.
Scene with_penumbra(const Eigen::Isometry3d& motion) {
  Scene scene = empty_scene({grey(0), grey(0)});
  scene = with_quad(std::move(scene), {Point(-2, -2, 0), Point(2, -2, 0), Point(2, 2, 0), Point(-2, 2, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, .5), Point(1, 0, .5), Point(1, 1, .5), Point(0, 1, .5)}, 1);
  for (Point& point : scene.vertices) point = motion * point;
  Luminaire lamp;
  lamp.position = motion * Point(0, 0, 1.5);
  lamp.light = SphericalLamp{0.2, Spectrum::Constant(1, 1)};
  scene.luminaires = {lamp};
  scene.up = motion.linear() * Vector::UnitZ();
  return scene;
}

Scene under_the_sky(const Eigen::Isometry3d& motion) {
  Scene scene = with_penumbra(motion);
  scene.luminaires.clear();
  scene.sky = Sky{.kind = SkyKind::cie_overcast, .horizontal_irradiance = Spectrum::Constant(1, 1)};
  return scene;
}

// The scene unchanged, and after a motion.
std::array<Eigen::Isometry3d, 2> motions() {
  Eigen::Isometry3d turned(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  turned.pretranslate(Vector(3, -5, 7));
  return {Eigen::Isometry3d::Identity(), turned};
}

// Many seeds, and a reference of many samples.
struct Runs {
  std::vector<DirectIrradiance> seeds;
  Field reference;
  Eigen::Array<bool, Eigen::Dynamic, 1> counts;  // tested receivers
};

// The mean of the squares of (difference from the reference) / (standard error).
double mean_chi_square(const Runs& runs) {
  double sum = 0;
  double number = 0;
  for (const DirectIrradiance& run : runs.seeds) {
    for (Eigen::Index i = 0; i < runs.counts.size(); ++i) {
      if (!runs.counts[i]) continue;
      const double rounding = 1e-9 * runs.reference(i, 0);
      const double variance = std::pow(run.standard_error(i, 0), 2) + rounding * rounding;
      sum += std::pow(run.irradiance(i, 0) - runs.reference(i, 0), 2) / variance;
      ++number;
    }
  }
  return sum / number;
}

constexpr LightingOptions many{.luminaire_samples = 1 << 11, .sky_samples = 1 << 13, .seed = 99};

// The same with a plate that transmits everything.
Scene with_clear_plate(Scene scene) {
  scene.materials[1].transmittance = Spectrum::Constant(1, 1);
  return scene;
}

// Only receivers count from which the plate hides a part of the light.
Runs with_reference(std::vector<DirectIrradiance> seeds, const Field& reference, const Field& unshadowed) {
  return {std::move(seeds), reference,
          reference.col(0) > 1e-3 * unshadowed.col(0) && reference.col(0) < 0.999 * unshadowed.col(0)};
}

Runs on_patches(const Scene& scene, double max_edge = 0.25) {
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), max_edge);
  const auto on = [&](const Scene& of, const LightingOptions& options) {
    return direct_irradiance(lighting_of(of, Tracing(of)), mesh, options);
  };
  const Eigen::Map<const Eigen::VectorXd> area(mesh.area.data(), mesh.size());
  std::vector<DirectIrradiance> seeds;
  for (std::uint64_t seed = 1; seed <= number_of_seeds; ++seed) {
    seeds.push_back(on(scene, {.seed = seed}));
    seeds.back().standard_error = with_errors_around(mesh, area, seeds.back().standard_error);
  }
  return with_reference(std::move(seeds), on(scene, many).irradiance, on(with_clear_plate(scene), many).irradiance);
}

Runs at_points(const Scene& scene, const Eigen::Isometry3d& motion, int luminaire_samples = 64) {
  std::vector<SurfacePoint> points;
  for (int k = 0; k < 30; ++k)
    points.push_back({motion * Point(-0.4 + 0.04 * k, 0.7, 0.001), motion.linear() * Vector::UnitZ(), no_polygon});
  const auto at = [&](const Scene& of, const LightingOptions& options) {
    return direct_irradiance(lighting_of(of, Tracing(of)), points, options);
  };
  std::vector<DirectIrradiance> seeds;
  for (std::uint64_t seed = 1; seed <= number_of_seeds; ++seed)
    seeds.push_back(at(scene, {.luminaire_samples = luminaire_samples, .seed = seed}));
  LightingOptions reference = many;
  reference.luminaire_samples = 32 * luminaire_samples;
  return with_reference(std::move(seeds), at(scene, reference).irradiance,
                        at(with_clear_plate(scene), reference).irradiance);
}

// Exact standard errors have a mean of 1, those of 16 replicates 15 / 13, and those of four 3. The mean is higher if
// four agree by chance. Overestimated errors are allowed. The mean over a few hundred correlated receivers and seeds is
// known to about a third.
constexpr double highest_chi_square = 1.5;

TEST(LightErrors, OfABallsSoftShadowHoldOnPatches) {
  for (const auto& motion : motions())
    EXPECT_LT(mean_chi_square(on_patches(with_penumbra(motion))), highest_chi_square);
}

// A floor with one face per patch.
TEST(LightErrors, OfABallsSoftShadowHoldOnPatchesThatAreFacesOfTheirOwn) {
  Scene scene = with_penumbra(Eigen::Isometry3d::Identity());
  const auto vertex = [&](int x, int y) { return static_cast<std::uint32_t>(8 + 17 * y + x); };
  for (int y = 0; y <= 16; ++y)
    for (int x = 0; x <= 16; ++x) scene.vertices.emplace_back(-2 + 0.25 * x, -2 + 0.25 * y, 0);
  scene.polygons.erase(scene.polygons.begin());
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) {
      Polygon face;
      face.corners = {vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)};
      scene.polygons.push_back(face);
    }
  }
  EXPECT_LT(mean_chi_square(on_patches(scene, 0.5)), highest_chi_square);
}

TEST(LightErrors, OfABallsSoftShadowHoldAtPoints) {
  for (const auto& motion : motions())
    EXPECT_LT(mean_chi_square(at_points(with_penumbra(motion), motion)), highest_chi_square);
}

// An edge cuts all lamps of a row in the same way. Their errors are independent, though their shadows are the same.
TEST(LightErrors, OfManyBallsAddUp) {
  const auto motion = Eigen::Isometry3d::Identity();
  Scene scene = with_penumbra(motion);
  scene = with_quad(std::move(scene), {Point(0, -9, .5), Point(9, -9, .5), Point(9, 9, .5), Point(0, 9, .5)}, 1);
  const Luminaire lamp = scene.luminaires[0];
  scene.luminaires.assign(16, lamp);
  for (std::size_t k = 0; k < 16; ++k) scene.luminaires[k].position = Point(0, 0.3 * static_cast<double>(k) - 1.7, 1.5);
  EXPECT_LT(mean_chi_square(at_points(scene, motion, 16)), highest_chi_square);
}

TEST(LightErrors, OfTheSkyHoldOnPatches) {
  for (const auto& motion : motions())
    EXPECT_LT(mean_chi_square(on_patches(under_the_sky(motion), 0.5)), highest_chi_square);
}

TEST(LightErrors, OfTheSkyHoldAtPoints) {
  for (const auto& motion : motions())
    EXPECT_LT(mean_chi_square(at_points(under_the_sky(motion), motion)), highest_chi_square);
}

TEST(LightErrors, OfABallThatNothingCanHideAreOfItsCosineAlone) {
  // The floor alone: M (r / d)^2 cos theta at every point, to the sampling error of the ball's cosine. The error 3 / n
  // of rays that may have missed an obstacle does not apply.
  Scene scene = with_penumbra(Eigen::Isometry3d::Identity());
  scene.polygons.pop_back();
  const SurfacePoint below{Point(0, 0, 0.001), Vector::UnitZ(), no_polygon};
  const DirectIrradiance direct = direct_irradiance(lighting_of(scene, Tracing(scene)), {&below, 1});
  const double expected = std::pow(0.2 / 1.499, 2);
  EXPECT_NEAR(direct.irradiance(0, 0), expected, 1e-4 * expected);
  EXPECT_LT(direct.standard_error(0, 0), 1e-4 * expected);
}

}  // namespace
}  // namespace patchlight::light_errors_test
