// The stated errors of sampled exchange areas match their true errors.
#include "patchlight/transport/assemble.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace patchlight::calibration_test {
namespace {

using namespace test;

// A room with rows of boxes, in which many pairs are partly hidden from each other.
Scene cluttered_room() {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(4, 3, 2.5), true);
  for (int k = 0; k < 6; ++k) {
    const Point corner(0.4 + 0.6 * k, 0.5 + 0.3 * (k % 3), 0.2);
    scene = with_box(std::move(scene), corner, corner + Vector(0.3, 1.1, 1.3), false);
  }
  return scene;
}

// Compares every sampled pair with a reference of 25 times the samples, whose error is at most a fifth.
class Calibration : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Scene scene = cluttered_room();
    const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 0.4);
    const Occluder occluder(scene);
    shapes = patch_shapes(mesh);
    assembly = new Assembly(assemble_exchange_areas(mesh, occluder, {8, 1, true}));
    reference = new Assembly(assemble_exchange_areas(mesh, occluder, {200, 7}));
  }
  static void TearDownTestSuite() {
    delete assembly;
    delete reference;
  }
  static double entry(PatchIndex i, PatchIndex j) { return assembly->exchange_areas.at(i, j); }
  static double error(PatchIndex i, PatchIndex j) { return entry(i, j) - reference->exchange_areas.at(i, j); }
  static double unoccluded(PatchIndex i, PatchIndex j) { return unoccluded_exchange_area(shapes[i], shapes[j]); }

  // Calls use(i, j) for the pairs whose entries are of this kind.
  template <typename Use>
  static void for_pairs(EntryKind kind, Use use) {
    for (PatchIndex j = 0; j < shapes.size(); ++j) {
      for (PatchIndex i = 0; i < j; ++i) {
        if (assembly->entry_errors.kind(i, j) == kind) use(i, j);
      }
    }
  }
  static inline std::vector<PatchShape> shapes;
  static inline Assembly* assembly = nullptr;
  static inline Assembly* reference = nullptr;
};

TEST_F(Calibration, StandardErrorsOfPartlyVisiblePairsHold) {
  double pairs = 0;
  double within = 0;
  double squares = 0;
  for_pairs(EntryKind::estimated, [&](PatchIndex i, PatchIndex j) {
    const double z = error(i, j) / assembly->entry_errors.standard_error(i, j);
    ++pairs;
    within += std::abs(z) <= 1.96 ? 1 : 0;
    squares += z * z;
  });
  ASSERT_GT(pairs, 2000);
  // Errors are not exactly normal. For pairs with few blocked rays, the stated error comes from other pairs.
  EXPECT_GT(within / pairs, 0.90);
  EXPECT_LT(within / pairs, 0.99);
  EXPECT_GT(std::sqrt(squares / pairs), 0.8);
  EXPECT_LT(std::sqrt(squares / pairs), 1.25);
}

// The stated error is the unoccluded value times the audit's error for the visible fraction and the effort. U is known
// to 6 %, which may select an adjacent bin or effort. The result is right to 12 %.
TEST_F(Calibration, StandardErrorsAreThoseOfTheAudit) {
  for_pairs(EntryKind::estimated, [&](PatchIndex i, PatchIndex j) {
    const double U = unoccluded(i, j);
    const double smaller = std::min(shapes[i].area, shapes[j].area);
    double lowest = 1;
    double highest = 0;
    for (const double share : {0.94 * entry(i, j) / U, entry(i, j) / U, 1.07 * entry(i, j) / U}) {
      for (const double form_factor : {0.94 * U / smaller, 1.07 * U / smaller}) {
        const double stated = standard_error(assembly->error, share, sampling_effort(form_factor));
        lowest = std::min(lowest, stated);
        highest = std::max(highest, stated);
      }
    }
    EXPECT_GT(assembly->entry_errors.standard_error(i, j), 0.88 * U * lowest);
    EXPECT_LT(assembly->entry_errors.standard_error(i, j), 1.13 * U * highest);
  });
}

TEST_F(Calibration, BoundsOfUnanimousPairsHold) {
  for (const bool visible : {true, false}) {
    const SamplingError::Unanimous& kind = visible ? assembly->error.visible : assembly->error.occluded;
    EXPECT_GT(kind.pairs(), 100U);
    EXPECT_LT(bound_on_miss(kind), 0.5) << "a bound that is always large is none";
    double pairs = 0;
    double within = 0;
    for_pairs(visible ? EntryKind::all_visible : EntryKind::all_hidden, [&](PatchIndex i, PatchIndex j) {
      ++pairs;
      within += std::abs(error(i, j)) <= bound_on_miss(kind) * unoccluded(i, j) ? 1 : 0;
    });
    ASSERT_GT(pairs, 2000);
    EXPECT_GT(within / pairs, 0.95);
  }
}

// The errors have no common sign: over all sampled pairs, including those whose rays agree, they are as large as stated
// and cancel in the sum. The unit is m^2, of the exchange in the whole room.
TEST_F(Calibration, ErrorsOfAllSampledPairsCancelAsStated) {
  double sum = 0;
  double variance = 0;
  for (const EntryKind kind : {EntryKind::estimated, EntryKind::all_visible, EntryKind::all_hidden}) {
    for_pairs(kind, [&](PatchIndex i, PatchIndex j) {
      const double U = unoccluded(i, j);
      const std::uint32_t effort = sampling_effort(U / std::min(shapes[i].area, shapes[j].area));
      const SamplingError& audit = assembly->error;
      const double sigma =
          kind == EntryKind::estimated
              ? assembly->entry_errors.standard_error(i, j)
              : U * standard_error(kind == EntryKind::all_visible ? audit.visible : audit.occluded, effort);
      sum += error(i, j);
      variance += sigma * sigma;
    });
  }
  EXPECT_LT(std::abs(sum), 3 * std::sqrt(variance));
}

// Rays that agree miss small parts, and the audit estimates how often. A reference with many more rays finds the same
// rate, within three standard errors of the audit's count. It counts parts that the audit's rays find with an even
// chance, so the audit may find fewer but not more.
TEST_F(Calibration, TheAuditFindsWhatRaysMiss) {
  double pairs = 0;
  double missed = 0;
  for_pairs(EntryKind::all_visible, [&](PatchIndex i, PatchIndex j) {
    const double smaller = std::min(shapes[i].area, shapes[j].area);
    const double rays = 8 * sampling_effort(unoccluded(i, j) / smaller);
    ++pairs;
    missed += error(i, j) > entry(i, j) / (2 * rays) ? 1 : 0;
  });
  const SamplingError::Unanimous& kind = assembly->error.visible;
  const double rate = missed / pairs;
  const double found = static_cast<double>(kind.missed) / static_cast<double>(kind.pairs());
  const double spread = 3 * std::sqrt(rate * (1 - rate) / static_cast<double>(kind.pairs()));
  EXPECT_GT(missed, 0);
  EXPECT_GT(found, 0.5 * rate - spread);
  EXPECT_LT(found, rate + spread);
}

}  // namespace
}  // namespace patchlight::calibration_test
