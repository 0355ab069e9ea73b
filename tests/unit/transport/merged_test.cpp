
#include "base/parallel.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "support/scenes.h"
#include "support/tiny_scenes.h"
#include "transport/closure.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <utility>

namespace patchlight::merged_test {
namespace {

constexpr double single = std::numeric_limits<float>::epsilon();

NestedMesh nested_room() {
  const Scene scene = test::furnished_room(0.5);
  return nest(tessellate(scene, tiny::front_sides(scene), 1));
}

// Invented exchange areas from 0 to 1, and remainders.
ClosedExchangeAreas made_up(PatchIndex size) {
  ExchangeAreas S(size);
  for (PatchIndex i = 0; i < size; ++i) {
    for (PatchIndex j = i + 1; j < size; ++j)
      S.set(i, j, static_cast<float>(std::abs(std::sin(1.7 * i + 0.3 * j * j))));
  }
  return {std::move(S), Eigen::VectorXd::LinSpaced(size, 0.5, 0.1), "test"};
}

double summed(const ExchangeAreas& S, PatchRange g, PatchRange h) {
  double sum = 0;
  for (PatchIndex i = g.begin; i < g.end; ++i) {
    for (PatchIndex j = h.begin; j < h.end; ++j) sum += static_cast<double>(S.at(i, j));
  }
  return sum;
}

TEST(Merged, EntriesAreSumsOverThePatches) {
  const NestedMesh mesh = nested_room();
  const ClosedExchangeAreas fine = made_up(mesh.patches.size());
  const ClosedExchangeAreas coarse = merged(fine, mesh);
  ASSERT_EQ(coarse.exchange_areas.size(), mesh.parents.size());
  for (PatchIndex G = 0; G < mesh.parents.size(); ++G) {
    for (PatchIndex H = 0; H < G; ++H) {
      const double sum = summed(fine.exchange_areas, mesh.patches_of(G), mesh.patches_of(H));
      const auto entry = static_cast<double>(coarse.exchange_areas.at(G, H));
      EXPECT_EQ(entry, static_cast<double>(coarse.exchange_areas.at(H, G)));
      // Narrowed toward zero, apart from the order of at most 16 summands in double.
      EXPECT_LE(entry, sum * (1 + 1e-14));
      EXPECT_GE(entry, sum * (1 - single));
    }
  }
}

// Rows of the parents have the same sums as those of their patches, so closure is preserved.
TEST(Merged, KeepsRowSums) {
  const NestedMesh mesh = nested_room();
  const ClosedExchangeAreas fine = made_up(mesh.patches.size());
  const ClosedExchangeAreas coarse = merged(fine, mesh);
  const Eigen::VectorXd rows = row_sums(fine.exchange_areas) + fine.remainder;
  const Eigen::ArrayXd expected = summed_by_parent(mesh, rows.array()).col(0);
  const Eigen::ArrayXd found = (row_sums(coarse.exchange_areas) + coarse.remainder).array();
  // Sums of `size` terms in double, in another order.
  const double rounding = mesh.patches.size() * std::numeric_limits<double>::epsilon();
  EXPECT_LT(((found - expected) / expected).abs().maxCoeff(), rounding);
}

// Law: if all patches of a parent have one radiosity, the mean irradiance of each parent is that of its patches.
TEST(Merged, GivesTheMeanIrradianceOfWhatIsConstantOnParents) {
  const NestedMesh mesh = nested_room();
  const PatchIndex size = mesh.patches.size();
  ClosedExchangeAreas fine = made_up(size);
  ClosedExchangeAreas coarse = merged(fine, mesh);
  const Eigen::VectorXd area = row_sums(fine.exchange_areas) + fine.remainder;
  const Eigen::VectorXd area_of_parents = summed_by_parent(mesh, area.array()).col(0).matrix();
  Field B(mesh.parents.size(), 2);
  for (PatchIndex G = 0; G < mesh.parents.size(); ++G) B.row(G) << 1 + G % 3, std::abs(std::cos(G));

  const Field means = means_by_parent(mesh, dense_transport(std::move(fine), area)->apply(of_parents(mesh, B)), area);
  const Field found = dense_transport(std::move(coarse), area_of_parents)->apply(B);
  // Each entry is narrowed by less than one step of a float. Values are up to 3, and rows of F sum to 1. The loss is
  // returned as the parent's own light.
  EXPECT_LT((found - means).abs().maxCoeff(), 3 * single);
}

TEST(EffectsOfParts, AreTheSquaredSumsOverTheParts) {
  const NestedMesh mesh = nested_room();
  const PatchIndex size = mesh.patches.size();
  const ClosedExchangeAreas fine = made_up(size);
  Field difference(size, 2), weight(size, 2);
  for (PatchIndex i = 0; i < size; ++i) {
    difference.row(i) << std::sin(i), std::cos(2.0 * i);
    weight.row(i) << 1 + i % 4, 2;
  }
  const auto effects = [&](int threads) {
    const ThreadLimit limit(threads);
    return effects_of_parts(fine.exchange_areas, mesh, difference, weight);
  };
  const Eigen::VectorXd found = effects(1);
  for (PatchIndex G = 0; G < mesh.parents.size(); ++G) {
    const PatchRange g = mesh.patches_of(G);
    double expected = 0;
    for (PatchIndex i = 0; i < size; ++i) {
      // A parent has no effect on itself: its patches lie in one plane.
      if (mesh.parent[i] == G) continue;
      for (Eigen::Index band = 0; band < 2; ++band) {
        double sum = 0;
        for (PatchIndex c = g.begin; c < g.end; ++c) {
          sum += static_cast<double>(fine.exchange_areas.at(c, i)) * difference(c, band);
        }
        expected += weight(i, band) * sum * sum;
      }
    }
    // `size` positive terms in another order.
    EXPECT_NEAR(found[G], expected, size * std::numeric_limits<double>::epsilon() * expected);
  }
  EXPECT_EQ(effects(2), found);
}

}  // namespace
}  // namespace patchlight::merged_test
