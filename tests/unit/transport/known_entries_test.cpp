#include "patchlight/solve/solve.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/exchange.h"

#include "base/parallel.h"
#include "base/sampling.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "pipeline/problem_of.h"
#include "support/scenes.h"
#include "support/test_room.h"
#include "support/tiny_scenes.h"
#include "transport/closure.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <utility>
#include <vector>

namespace patchlight::known_entries_test {
namespace {

const AssemblyOptions keep_errors{.keep_errors = true};

std::vector<std::uint8_t> some_parents(const NestedMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint8_t> marks;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) marks.push_back(hash({seed, g}) % 9 == 0 ? 1 : 0);
  return marks;
}

// Differences of two assemblies of one mesh.
struct Differences {
  double largest = 0;  // |a - b| / (max(a, b) + min(A_i, A_j)), and the same of the differences of their halves
  std::size_t in_one_only = 0;  // entries whose halves differ in only one of them
};

Differences between(const Assembly& one, const Assembly& other, const PatchMesh& mesh) {
  Differences found;
  for (PatchIndex j = 0; j < mesh.size(); ++j) {
    for (PatchIndex i = 0; i < j; ++i) {
      const auto a = static_cast<double>(one.exchange_areas.at(i, j));
      const auto b = static_cast<double>(other.exchange_areas.at(i, j));
      // Rounding may move a difference of halves to the next step of its logarithm, or below the smallest.
      const double c = one.half_differences.at(i, j);
      const double d = other.half_differences.at(i, j);
      const double step = (std::exp2(0.25) - 1 + 1e-9) * std::min(std::abs(c), std::abs(d)) +
                          std::exp2(-126 / 4.0) * std::sqrt(mesh.area[i] * mesh.area[j]);
      const double size = std::max(a, b) + std::min(mesh.area[i], mesh.area[j]);
      found.largest = std::max({found.largest, std::abs(a - b) / size, (std::abs(c - d) - step) / size});
      const bool differs = std::max(std::abs(c), std::abs(d)) > 1e-6 * size;  // by more than rounding
      found.in_one_only += differs && (c == 0 || d == 0) ? 1 : 0;
    }
  }
  return found;
}

// Closed and solved to 1e-9.
Solution solved(Assembly raw, const PatchMesh& mesh, const Occluder& occluder, const RadiosityProblem& problem) {
  Exchange exchange = exchange_of(std::move(raw), mesh, measure_lost_share(mesh, occluder, 64, 1));
  const Eigen::VectorXd area = exchange.area;
  return solve(*dense_transport(close_exchange(std::move(exchange)), area), problem, {.relative_error = 1e-9});
}

// Theorem: reuse of entries from mesh to mesh gives the same result as a new assembly, because samples depend only on
// the two patches of a pair. Two things depend on their clusters, which change when a patch nearby is cut. The first is
// rounding: positions are floats in the cluster's frame, about 1e-7 of its size. The second is the choice to trace
// shadow rays, which is skipped for clusters with nothing between them. That matters where one patch rises slightly
// above the plane of the other. All rays may miss the visible sliver, about 1e-5 of the hemisphere. Misses are random,
// and the solutions differ by about 1e-6. Three refinements, each from the result of the previous one.
TEST(KnownEntries, GiveWhatAFreshAssemblyGives) {
  for (const Scene& scene : {test::furnished_room(0.5), test::test_room(0.8)}) {
    const Occluder occluder(scene);
    NestedMesh mesh = nest(tessellate(scene, tiny::front_sides(scene), 1.2));
    Assembly known = assemble_exchange_areas(mesh.patches, occluder, keep_errors);
    for (std::uint64_t round = 0; round < 3; ++round) {
      FinerMesh finer = refine(mesh, some_parents(mesh, round));
      mesh = std::move(finer.mesh);
      Assembly fresh = assemble_exchange_areas(mesh.patches, occluder, keep_errors);
      Assembly taken_over =
          assemble_exchange_areas(mesh.patches, occluder, keep_errors, {known, std::move(finer.place)});
      const Differences found = between(taken_over, fresh, mesh.patches);
      EXPECT_LT(found.largest, 1e-4);
      EXPECT_EQ(found.in_one_only, 0U);
      // It is cheaper, or nothing was reused.
      EXPECT_LT(taken_over.counts.shadow_rays, fresh.counts.shadow_rays);

      const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.patches.area.data(), mesh.patches.size());
      const RadiosityProblem problem = problem_of(scene, mesh.patches, area, false);
      known = taken_over;
      const Solution expected = solved(std::move(fresh), mesh.patches, occluder, problem);
      const Solution incremental = solved(std::move(taken_over), mesh.patches, occluder, problem);
      EXPECT_LT(relative_error(expected.radiosity, incremental.radiosity, problem), 2e-6);
    }
  }
}

TEST(KnownEntries, GiveTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = test::furnished_room(0.5);
  const Occluder occluder(scene);
  const NestedMesh mesh = nest(tessellate(scene, tiny::front_sides(scene), 0.9));
  const Assembly known = assemble_exchange_areas(mesh.patches, occluder, keep_errors);
  const FinerMesh finer = refine(mesh, some_parents(mesh, 1));
  const auto assembled = [&](int threads) {
    const ThreadLimit limit(threads);
    return assemble_exchange_areas(finer.mesh.patches, occluder, keep_errors, {known, finer.place});
  };
  const Assembly one = assembled(1);
  const Assembly two = assembled(2);
  EXPECT_EQ(between(one, two, finer.mesh.patches).largest, 0);
  EXPECT_EQ(one.counts.shadow_rays, two.counts.shadow_rays);
  EXPECT_TRUE(std::ranges::equal(one.half_differences.codes(), two.half_differences.codes()));
}

// If everything is known there is nothing to compute.
TEST(KnownEntries, OfTheSameMeshCostNothing) {
  const Scene scene = test::furnished_room(0.5);
  const Occluder occluder(scene);
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.5);
  const Assembly known = assemble_exchange_areas(mesh, occluder, keep_errors);
  std::vector<PatchIndex> place;
  for (PatchIndex i = 0; i < mesh.size(); ++i) place.push_back(i);
  const Assembly again = assemble_exchange_areas(mesh, occluder, keep_errors, {known, place});
  EXPECT_EQ(between(again, known, mesh).largest, 0);
  EXPECT_EQ(again.counts.shadow_rays, 0U);
  EXPECT_TRUE(std::ranges::equal(again.half_differences.codes(), known.half_differences.codes()));
}

}  // namespace
}  // namespace patchlight::known_entries_test
