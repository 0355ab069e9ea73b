// The estimators agree, and the shortcuts of the automatic estimator change no more than their limits allow.
#include "patchlight/transport/assemble.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::estimators_test {
namespace {

using namespace test;

PatchMesh fronts(const Scene& scene, double max_edge) {
  return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
}

std::string name(const testing::TestParamInfo<Estimator>& info) {
  std::string text = name_of(info.param);
  std::erase(text, '-');
  return text;
}

// The mean exchange areas between polygons over many seeds, and their standard errors.
struct Mean {
  Eigen::ArrayXXd value;
  Eigen::ArrayXXd error;
};

Mean mean_over_seeds(const PatchMesh& mesh, const Occluder& occluder, AssemblyOptions options, int seeds) {
  const auto groups = static_cast<std::uint32_t>(mesh.first_patch.size() / 2);
  Eigen::ArrayXXd sum = Eigen::ArrayXXd::Zero(groups, groups);
  Eigen::ArrayXXd squares = sum;
  for (int seed = 1; seed <= seeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const Assembly assembly = assemble_exchange_areas(mesh, occluder, options);
    const Eigen::ArrayXXd areas = exchange_between_groups(assembly.exchange_areas, mesh.polygon, groups).array();
    sum += areas;
    squares += areas.square();
  }
  const double n = seeds;
  const Eigen::ArrayXXd variance = (squares / n - (sum / n).square()).max(0) / (n - 1);
  return {sum / n, variance.sqrt()};
}

class Estimators : public testing::TestWithParam<Estimator> {};

// Opposed unit squares at distance 1, one patch each: F = 0.199824896 (Howell, C-11). 64 seeds.
TEST_P(Estimators, AreRightWhereNothingIsInBetween) {
  Scene scene = with_quad(empty_scene({grey(0.5)}), {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  scene = with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 1, 1), Point(1, 1, 1), Point(1, 0, 1)});
  const PatchMesh mesh = fronts(scene, 2);
  const Mean mean = mean_over_seeds(mesh, Occluder(scene), {.estimator = GetParam()}, 64);
  // Four standard errors. Closed forms have no sampling error, but are stored as floats.
  EXPECT_NEAR(mean.value(0, 1), 0.199824896, 4 * mean.error(0, 1) + 1e-7);
  EXPECT_LT(mean.error(0, 1), 0.01) << "too wide to tell anything";
}

INSTANTIATE_TEST_SUITE_P(All, Estimators,
                         testing::Values(Estimator::automatic, Estimator::area, Estimator::point_polygon,
                                         Estimator::hemisphere, Estimator::contour),
                         name);

class OtherEstimators : public testing::TestWithParam<Estimator> {};

// A closed room with a box, 64 seeds, against the automatic estimator with many rays. The tolerance is 1e-3, for the
// far rule, plus five standard errors of each of the 4 x 78 pairs of polygons. These come from only 64 values: the
// samples between touching patches follow 1 / r^2, so most lie below the mean and underestimate the scatter. If hardly
// a ray arrives and nothing scatters, nine rays may be missing; all of them miss with a probability of exp(-9).
TEST_P(OtherEstimators, AgreeWithTheAutomaticOne) {
  constexpr int seeds = 64;
  const bool of_patches = GetParam() == Estimator::hemisphere;
  const int samples = of_patches ? 512 : 64;  // per patch or per pair
  const Scene scene = furnished_room(0.5);
  const PatchMesh mesh = fronts(scene, 1);
  const Occluder occluder(scene);
  const Mean reference = mean_over_seeds(mesh, occluder, {.samples = 256}, 4);
  const Mean mean = mean_over_seeds(mesh, occluder, {.samples = samples, .estimator = GetParam()}, seeds);
  const double largest = *std::max_element(mesh.area.begin(), mesh.area.end());
  const double few_rays = of_patches ? 9 * largest / (2 * samples * seeds) : 0;
  int pairs = 0;
  int sharp = 0;
  for (Eigen::Index a = 0; a < mean.value.rows(); ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      const double expected = reference.value(a, b);
      if (expected == 0 && mean.value(a, b) == 0) continue;
      const double allowed = 5 * std::hypot(mean.error(a, b), reference.error(a, b)) + 1e-3 * expected + few_rays;
      EXPECT_NEAR(mean.value(a, b), expected, allowed) << "polygons " << a << " and " << b;
      ++pairs;
      sharp += allowed < 0.1 * expected ? 1 : 0;
    }
  }
  EXPECT_GT(pairs, 40);
  EXPECT_GT(sharp, pairs / 2) << "too wide to tell anything";
}

INSTANTIATE_TEST_SUITE_P(All, OtherEstimators,
                         testing::Values(Estimator::area, Estimator::point_polygon, Estimator::hemisphere,
                                         Estimator::contour),
                         name);

// The furnished room with a screen across it.
Scene divided_room() { return with_box(furnished_room(0.5), Point(2.1, 0.2, 0.1), Point(2.2, 2.8, 2.4), false); }

// The divided room with all shortcuts, and with all but some.
class ShortCut : public testing::Test {
 protected:
  Assembly assembled(const ShortCuts& short_cuts) const {
    return assemble_exchange_areas(mesh, occluder, {.keep_errors = true, .short_cuts = short_cuts});
  }
  template <typename Use>
  void for_pairs(Use use) const {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      for (PatchIndex i = 0; i < j; ++i) use(i, j);
    }
  }
  const Scene scene = divided_room();
  const PatchMesh mesh = fronts(scene, 0.4);
  const Occluder occluder{scene};
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  const Assembly all = assembled({});
};

// All rays through polygons that hide the whole pair are blocked.
TEST_F(ShortCut, HiddenChangesNothing) {
  const Assembly without = assembled({.hidden = false});
  EXPECT_GT(all.counts.hidden_pairs, 0U);
  EXPECT_EQ(without.counts.hidden_pairs, 0U);
  EXPECT_GT(without.counts.shadow_rays, all.counts.shadow_rays);
  for_pairs(
      [&](PatchIndex i, PatchIndex j) { EXPECT_EQ(without.exchange_areas.at(i, j), all.exchange_areas.at(i, j)); });
}

// All rays through empty shafts are free. If patches cross each other's plane, few samples or none lie where the
// patches see each other. The other samples run through solids, so rays are less reliable than the shaft.
TEST_F(ShortCut, FreeChangesNothing) {
  const Assembly without = assembled({.free = false});
  EXPECT_GT(all.counts.free_pairs, 1000U);
  EXPECT_EQ(without.counts.free_pairs, 0U);
  EXPECT_GT(without.counts.shadow_rays, all.counts.shadow_rays);
  std::uint64_t changed = 0;
  for_pairs([&](PatchIndex i, PatchIndex j) {
    const float entry = all.exchange_areas.at(i, j);
    if (without.exchange_areas.at(i, j) == entry) return;
    ++changed;
    EXPECT_EQ(orientation(shapes[i], shapes[j]), Orientation::straddling);
    EXPECT_LT(without.exchange_areas.at(i, j), entry) << "no more than the unoccluded value";
  });
  EXPECT_LT(changed, all.counts.free_pairs / 500);
}

// Both rules have an error of at most 1e-3 of the unoccluded value without small cosines, as here, and sampling removes
// a part of it. Form factors near a step in the number of samples are skipped: without the shortcut, the first samples
// estimate the side of the step.
TEST_F(ShortCut, FarChangesNoMoreThanBothRulesErr) {
  const Assembly without = assembled({.far = false});
  int changed = 0;
  for_pairs([&](PatchIndex i, PatchIndex j) {
    const double change = std::abs(without.exchange_areas.at(i, j) - all.exchange_areas.at(i, j));
    if (change == 0) return;
    const double U = unoccluded_exchange_area(shapes[i], shapes[j]);
    const double form_factor = U / std::min(shapes[i].area, shapes[j].area);
    if (sampling_effort(form_factor / 1.4) != sampling_effort(1.4 * form_factor)) return;
    ++changed;
    EXPECT_LE(change, 2e-3 * U) << i << ' ' << j;
  });
  EXPECT_GT(changed, 1000);
}

}  // namespace
}  // namespace patchlight::estimators_test
