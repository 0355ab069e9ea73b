#include "visibility/walk.h"

#include "patchlight/scene/scene.h"

#include "light/pane.h"
#include "support/scenes.h"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::walk_test {
namespace {

using namespace test;

// Two parallel panes of three bands across x, 1 m apart.
Scene two_panes() {
  Scene scene = empty_scene({{"glass", rgb(0, 0, 0), rgb(0, 0, 0)}});
  scene.materials[0].transmittance = rgb(0.8, 0.4, 0.1);
  for (const double x : {1.0, 2.0})
    scene = with_quad(std::move(scene), {Point(x, -9, -9), Point(x, 9, -9), Point(x, 9, 9), Point(x, -9, 9)});
  return scene;
}

struct Ends {
  Spectrum behind = Spectrum::Zero(3);  // throughput of the paths that leave along +x
  Spectrum before = Spectrum::Zero(3);
};

Ends ends_of_walk(const Occluder& occluder, const WalkOptions& options) {
  Ends ends;
  walk(occluder, occluder.optics(), {Ray{Point::Zero(), Vector::UnitX()}}, options,
       [&](const SpecularPath& path, const std::optional<Hit>& hit) {
         if (!hit) (path.ray.direction.x() > 0 ? ends.behind : ends.before) += path.throughput;
         return Continuation::specular;
       });
  return ends;
}

// T T / (1 - R R) of the light passes two panes; R + T T R / (1 - R R) comes back (Stokes 1862).
TEST(Walk, BetweenTwoPanesSumsTheirSeries) {
  const Occluder occluder(two_panes(), Occluder::Blockers::all, {}, Reflections::followed);
  const Ends ends = ends_of_walk(occluder, {.min_throughput = 1e-15});
  for (int band = 0; band < 3; ++band) {
    const Pane pane = pane_of(1.52, std::array{0.8, 0.4, 0.1}[static_cast<std::size_t>(band)]);
    const double T = transmittance(pane, 1), R = specular_reflectance(pane, 1);
    EXPECT_NEAR(ends.behind[band], T * T / (1 - R * R), 1e-12);
    EXPECT_NEAR(ends.before[band], R + T * T * R / (1 - R * R), 1e-12);
  }
}

// Roulette below a throughput of 1/2 keeps the mean over 4,000 seeds, within 5 of its standard errors.
TEST(Walk, RouletteKeepsTheMean) {
  const Occluder occluder(two_panes(), Occluder::Blockers::all, {}, Reflections::followed);
  const Spectrum exact = ends_of_walk(occluder, {.min_throughput = 1e-15}).before;
  constexpr int count = 4000;
  Spectrum sum = Spectrum::Zero(3), squares = sum;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const Spectrum one = ends_of_walk(occluder, {.min_throughput = 0.5, .seed = seed}).before;
    sum += one;
    squares += one.square();
  }
  const Spectrum mean = sum / count;
  const Spectrum error = ((squares / count - mean.square()) / count).sqrt();
  for (int band = 0; band < 3; ++band) EXPECT_LT(std::abs(mean[band] - exact[band]), 5 * error[band]) << band;
}

// Rays with different keys survive independently of each other, and those with equal keys alike.
TEST(Walk, SurvivalFollowsTheKey) {
  const Occluder occluder(two_panes(), Occluder::Blockers::all, {}, Reflections::followed);
  int alike = 0, all = 0;
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const std::vector<std::uint64_t> key{k}, other{k + 1000};
    const Spectrum one = ends_of_walk(occluder, {.min_throughput = 0.5, .keys = key}).before;
    EXPECT_TRUE((one == ends_of_walk(occluder, {.min_throughput = 0.5, .keys = key}).before).all());
    alike += (one == ends_of_walk(occluder, {.min_throughput = 0.5, .keys = other}).before).all() ? 1 : 0;
    ++all;
  }
  EXPECT_LT(alike, all);
}

}  // namespace
}  // namespace patchlight::walk_test
