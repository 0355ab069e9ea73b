#include "transport/emitter_factors.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/pair_sampler.h"
#include "visibility/occluder.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::emitter_factors_test {
namespace {

using namespace test;

constexpr PolygonIndex lamp_of_furnished_room = 12;

// A floor of 1 x 1 m under an emitter of 0.6 x 0.6 m at 2 m, with bars between them that leave slits. They hide most of
// the emitter from every point.
Scene under_bars(int bars, double slit) {
  Scene scene = empty_scene({grey(0.5), grey(0, 10)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene =
      with_quad(std::move(scene), {Point(0.2, 0.2, 2), Point(0.2, 0.8, 2), Point(0.8, 0.8, 2), Point(0.8, 0.2, 2)}, 1);
  const double step = 3.0 / bars;
  for (int k = 0; k < bars; ++k) {
    const double x = -1 + k * step;
    scene = with_quad(std::move(scene),
                      {Point(x, -1, 1), Point(x + step - slit, -1, 1), Point(x + step - slit, 2, 1), Point(x, 2, 1)});
  }
  return scene;
}

EmitterFactors factors_of(const Scene& scene, const PatchMesh& mesh, PolygonIndex emitter, std::uint64_t seed) {
  const Occluder occluder(scene);
  const EmitterSide side{emitter, Side::front};
  return emitter_factors(scene, mesh, occluder, {&side, 1}, {.seed = seed});
}

// With nothing in between, both halves are the closed form. The reference is the sum of exchange areas with the
// emitter's patches, which are accurate to 1e-3.
TEST(EmitterFactors, AreTheClosedFormWhereNothingIsBetween) {
  const Scene scene = under_bars(0, 0);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.2);
  const EmitterFactors factors = factors_of(scene, mesh, 1, 1);
  const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene)).exchange_areas;
  const PatchRange floor = mesh.patches_on(0, Side::front);
  const PatchRange emitter = mesh.patches_on(1, Side::front);
  for (PatchIndex i = floor.begin; i < floor.end; ++i) {
    double expected = 0;
    for (PatchIndex j = emitter.begin; j < emitter.end; ++j) expected += static_cast<double>(S.at(i, j)) / mesh.area[i];
    EXPECT_NEAR(factors.halves[0](i, 0), expected, 2e-3 * expected);
    EXPECT_EQ(factors.halves[0](i, 0), factors.halves[1](i, 0));
    EXPECT_EQ(factors.standard_error(i, 0), 0);
  }
  for (PatchIndex i = emitter.begin; i < emitter.end; ++i) EXPECT_EQ(factors.halves[0](i, 0), 0);
}

// Agreement of probes is not sufficient: through slits that leave 2 % of the emitter visible, 16 rays mostly meet only
// bars. The mean over patches, seeds and halves is compared with that of 4,096 rays for every pair.
TEST(EmitterFactors, HaveTheRightMeanBehindSlits) {
  const Scene scene = under_bars(30, 0.002);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.26);
  const Occluder occluder(scene);
  const PatchRange floor = mesh.patches_on(0, Side::front);

  const PatchIndex emitter = mesh.patches_on(1, Side::front).begin;
  double expected = 0;
  const std::uint32_t many = 4096;
  for (PatchIndex i = floor.begin; i < floor.end; ++i) {
    const PatchShape from = patch_shape(mesh, i);
    std::vector<Segment> segments;
    std::vector<double> weights;
    PatchCorners whole;
    for (std::size_t k = 0; k < 4; ++k) whole.points[k] = scene.vertices[scene.polygons[1].corners[k]];
    whole.count = 4;
    const PatchShape to = patch_shape(whole);
    for (std::uint32_t k = 0; k < many; ++k) {
      const auto u = [&](std::uint32_t d) { return (hash({i, k, d}) + 0.5) * 0x1p-32; };
      const PairSample sample = draw_by_area(from, to, {u(0), u(1), u(2), u(3)});
      segments.push_back({sample.from, sample.to, mesh.polygon[i], mesh.polygon[emitter]});
      weights.push_back(sample.weight / from.area);
    }
    const auto arriving = occluder.transmittance(segments);
    for (std::size_t k = 0; k < weights.size(); ++k) expected += weights[k] * arriving[k] / many;
  }

  constexpr int seeds = 64;
  double sum = 0;
  double squares = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const EmitterFactors factors = factors_of(scene, mesh, 1, static_cast<std::uint64_t>(seed));
    double of_seed = 0;
    for (PatchIndex i = floor.begin; i < floor.end; ++i)
      of_seed += 0.5 * static_cast<double>(factors.halves[0](i, 0) + factors.halves[1](i, 0));
    sum += of_seed;
    squares += of_seed * of_seed;
  }
  const double mean = sum / seeds;
  const double standard_error = std::sqrt((squares / seeds - mean * mean) / (seeds - 1));
  // The reference has 16 x 4096 rays, of which 2 % get through: 3 %.
  EXPECT_LT(standard_error, 0.05 * expected);
  EXPECT_NEAR(mean, expected, 3 * std::hypot(standard_error, 0.03 * expected));
}

// Half the difference of the halves and the stated error have the same mean square.
TEST(EmitterFactors, StateTheErrorsThatTheirHalvesShow) {
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.15);
  const EmitterFactors factors = factors_of(scene, mesh, lamp_of_furnished_room, 1);
  const double shown = (0.5 * (factors.halves[0] - factors.halves[1])).square().sum();
  const double stated = factors.standard_error.square().sum();
  EXPECT_GT(shown, 0);
  EXPECT_NEAR(std::sqrt(stated / shown), 1, 0.2);
  EXPECT_GT(factors.shadow_rays, 16U * mesh.size());
}

TEST(EmitterFactors, HaveTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.3);
  const auto found = [&](int threads) {
    const ThreadLimit limit(threads);
    return factors_of(scene, mesh, lamp_of_furnished_room, 1);
  };
  const EmitterFactors one = found(1);
  const EmitterFactors two = found(2);
  EXPECT_TRUE((one.halves[0] == two.halves[0]).all());
  EXPECT_TRUE((one.halves[1] == two.halves[1]).all());
  EXPECT_TRUE((one.standard_error == two.standard_error).all());
}

// A emitter other than a convex quadrilateral is the sum of its triangles: an L of three squares.
TEST(EmitterFactors, OfAnyPolygonAreThoseOfItsParts) {
  const auto floor = [] {
    return with_quad(empty_scene({grey(0.5), grey(0, 10)}),
                     {Point(0, 0, 0), Point(2, 0, 0), Point(2, 2, 0), Point(0, 2, 0)});
  };
  const Scene whole = with_polygon(
      floor(), {Point(0, 0, 2), Point(0, 2, 2), Point(1, 2, 2), Point(1, 1, 2), Point(2, 1, 2), Point(2, 0, 2)}, 1);
  Scene parts = with_quad(floor(), {Point(0, 0, 2), Point(0, 2, 2), Point(1, 2, 2), Point(1, 0, 2)}, 1);
  parts = with_quad(std::move(parts), {Point(1, 0, 2), Point(1, 1, 2), Point(2, 1, 2), Point(2, 0, 2)}, 1);
  const PatchMesh mesh = tessellate(whole, kept_sides(whole, Sides::front), 0.5);
  const PatchMesh of_parts = tessellate(parts, kept_sides(parts, Sides::front), 0.5);
  const EmitterFactors a = factors_of(whole, mesh, 1, 1);
  const EmitterFactors b = factors_of(parts, of_parts, 1, 1);
  const EmitterFactors c = factors_of(parts, of_parts, 2, 1);
  EXPECT_EQ(piece_count(whole, {1, Side::front}), 4U);
  for (PatchIndex i = 0; i < 16; ++i)
    EXPECT_NEAR(a.halves[0](i, 0), b.halves[0](i, 0) + c.halves[0](i, 0),
                1e-3 * static_cast<double>(a.halves[0](i, 0)));
}

}  // namespace
}  // namespace patchlight::emitter_factors_test
