#include "patchlight/base/parallel.h"
#include "patchlight/base/sampling.h"
#include "patchlight/mesh/mesher.h"
#include "patchlight/mesh/nested_mesh.h"
#include "patchlight/transport/assemble.h"

#include "support/scenes.h"
#include "support/test_room.h"
#include "support/tiny_scenes.h"

#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

std::vector<std::uint8_t> some_parents(const NestedMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint8_t> marks;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) marks.push_back(hash({seed, g}) % 9 == 0 ? 1 : 0);
  return marks;
}

// Entries that differ, and what one of them is about.
struct Differences {
  std::size_t entries = 0;
  std::size_t kinds = 0;
};

Differences between(const Assembly& one, const Assembly& other) {
  Differences found;
  for (PatchIndex j = 0; j < one.exchange_areas.size(); ++j) {
    for (PatchIndex i = 0; i < j; ++i) {
      found.entries += one.exchange_areas.at(i, j) != other.exchange_areas.at(i, j) ? 1 : 0;
      found.kinds += one.entry_errors.kind(i, j) != other.entry_errors.kind(i, j) ? 1 : 0;
    }
  }
  return found;
}

// Theorem: taking entries over from mesh to mesh gives what a fresh assembly gives, to the last bit, as the exchange
// area of a pair follows from its two patches alone. Three refinements, each from what the one before has left.
TEST(KnownEntries, GiveTheBitsOfAFreshAssembly) {
  for (const Scene& scene : {test::furnished_room(0.5), test::test_room(0.5)}) {
    const Occluder occluder(scene);
    const AssemblyOptions options{.keep_errors = true};
    NestedMesh mesh = nest(tessellate(scene, tiny::front_sides(scene), 0.9));
    Assembly known = assemble_exchange_areas(mesh.patches, occluder, options);
    for (std::uint64_t round = 0; round < 3; ++round) {
      FinerMesh finer = refine(mesh, some_parents(mesh, round));
      const Assembly fresh = assemble_exchange_areas(finer.mesh.patches, occluder, options);
      Assembly taken_over =
          assemble_exchange_areas(finer.mesh.patches, occluder, options, {known, std::move(finer.place)});
      const Differences found = between(taken_over, fresh);
      EXPECT_EQ(found.entries, 0U) << scene.polygons.size() << " polygons, round " << round;
      EXPECT_EQ(found.kinds, 0U) << scene.polygons.size() << " polygons, round " << round;
      // It is cheaper, or nothing was taken over.
      EXPECT_LT(taken_over.counts.shadow_rays, fresh.counts.shadow_rays);
      mesh = std::move(finer.mesh);
      known = std::move(taken_over);
    }
  }
}

TEST(KnownEntries, GiveTheSameBitsForAnyNumberOfThreads) {
  const Scene scene = test::furnished_room(0.5);
  const Occluder occluder(scene);
  const AssemblyOptions options{.keep_errors = true};
  const NestedMesh mesh = nest(tessellate(scene, tiny::front_sides(scene), 0.9));
  const Assembly known = assemble_exchange_areas(mesh.patches, occluder, options);
  const FinerMesh finer = refine(mesh, some_parents(mesh, 1));
  const auto assembled = [&](int threads) {
    const ThreadLimit limit(threads);
    return assemble_exchange_areas(finer.mesh.patches, occluder, options, {known, finer.place});
  };
  const Assembly one = assembled(1);
  const Assembly two = assembled(2);
  EXPECT_EQ(between(one, two).entries, 0U);
  EXPECT_EQ(one.counts.shadow_rays, two.counts.shadow_rays);
  EXPECT_EQ(one.error.squares, two.error.squares);
}

// When all is known there is nothing to do.
TEST(KnownEntries, OfTheSameMeshCostNothing) {
  const Scene scene = test::furnished_room(0.5);
  const Occluder occluder(scene);
  const AssemblyOptions options{.keep_errors = true};
  const PatchMesh mesh = tessellate(scene, tiny::front_sides(scene), 0.5);
  const Assembly known = assemble_exchange_areas(mesh, occluder, options);
  std::vector<PatchIndex> place;
  for (PatchIndex i = 0; i < mesh.size(); ++i) place.push_back(i);
  const Assembly again = assemble_exchange_areas(mesh, occluder, options, {known, place});
  EXPECT_EQ(between(again, known).entries, 0U);
  EXPECT_EQ(again.counts.shadow_rays, 0U);
  EXPECT_EQ(again.error.squares, known.error.squares);
}

}  // namespace
}  // namespace patchlight
