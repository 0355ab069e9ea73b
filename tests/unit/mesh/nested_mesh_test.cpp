#include "mesh/nested_mesh.h"

#include "base/sampling.h"
#include "mesh/mesher.h"
#include "support/polygon_shapes.h"
#include "support/scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace patchlight::nested_mesh_test {
namespace {

// A large floor, and a small face above it.
Scene large_and_small() {
  using namespace test;
  Scene scene = empty_scene({grey(0.5)});
  scene = with_quad(std::move(scene), {Point(0, 0, 0), Point(4, 0, 0), Point(4, 4, 0), Point(0, 4, 0)});
  return with_quad(std::move(scene), {Point(0, 0, 1), Point(0, 0.1, 1), Point(0.1, 0.1, 1), Point(0.1, 0, 1)});
}

PatchMesh mesh_of(const Scene& scene, double max_edge) { return tessellate(scene, tiny::front_sides(scene), max_edge); }

std::vector<std::uint8_t> some_parents(const NestedMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint8_t> marks;
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) marks.push_back(hash({seed, g}) % 7 == 0 ? 1 : 0);
  return marks;
}

Eigen::VectorXd areas(const PatchMesh& mesh) {
  return Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
}

bool same_corners(const PatchMesh& a, PatchIndex i, const PatchMesh& b, PatchIndex j) {
  const PatchCorners one = a.corner_points(i);
  const PatchCorners other = b.corner_points(j);
  return one.count == other.count &&
         std::equal(one.points.begin(), one.points.begin() + one.count, other.points.begin());
}

// The patches of a parent are those that refer to it, and they fill it.
void expect_consistent(const NestedMesh& mesh) {
  ASSERT_EQ(mesh.first_patch.size(), mesh.parents.size() + 1);
  ASSERT_EQ(mesh.parent.size(), mesh.patches.size());
  EXPECT_EQ(mesh.first_patch.front(), 0U);
  EXPECT_EQ(mesh.first_patch.back(), mesh.patches.size());
  for (PatchIndex g = 0; g < mesh.parents.size(); ++g) {
    const PatchRange range = mesh.patches_of(g);
    EXPECT_TRUE(range.end - range.begin == 4 || range.end - range.begin == 1);
    for (PatchIndex i = range.begin; i < range.end; ++i) {
      EXPECT_EQ(mesh.parent[i], g);
      EXPECT_EQ(mesh.patches.polygon[i], mesh.parents.polygon[g]);
    }
  }
  const Eigen::ArrayXd sums = summed_by_parent(mesh, areas(mesh.patches).array()).col(0);
  EXPECT_LT((sums - areas(mesh.parents).array()).abs().maxCoeff(), 1e-14);
}

TEST(NestedMesh, LargeParentsHaveFourPatchesSmallOnesStayWhole) {
  const NestedMesh mesh = nest(mesh_of(large_and_small(), 2));
  expect_consistent(mesh);
  ASSERT_EQ(mesh.parents.size(), 5U);
  for (PatchIndex g = 0; g < 5; ++g) {
    const PatchRange range = mesh.patches_of(g);
    EXPECT_EQ(range.end - range.begin, mesh.parents.polygon[g] == 0 ? 4U : 1U);
  }
}

TEST(NestedMesh, StaysConsistentWhenItIsRefined) {
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    NestedMesh mesh = nest(mesh_of(shape.scene, 0.7));
    expect_consistent(mesh);
    for (std::uint64_t round = 0; round < 3; ++round) {
      mesh = refine(mesh, some_parents(mesh, round)).mesh;
      expect_consistent(mesh);
    }
  }
}

// Parents from earlier cuts are small, but they are not small faces of a model: they are cut again.
TEST(NestedMesh, TheSamePlaceCanBeCutAgainAndAgain) {
  NestedMesh mesh = nest(mesh_of(large_and_small(), 2));
  double smallest = 1;
  for (int round = 0; round < 6; ++round) {
    std::vector<std::uint8_t> marks(mesh.parents.size(), 0);
    marks[0] = 1;
    ASSERT_EQ(mesh.parents.polygon[0], 0U);
    mesh = refine(mesh, marks).mesh;
    expect_consistent(mesh);
    double on_floor = 16;
    int on_small_face = 0;
    for (PatchIndex i = 0; i < mesh.patches.size(); ++i) {
      if (mesh.patches.polygon[i] == 0) on_floor = std::min(on_floor, mesh.patches.area[i]);
      on_small_face += mesh.patches.polygon[i] == 1 ? 1 : 0;
    }
    // Sides are powers of two, so sums are exact.
    EXPECT_EQ(on_floor, smallest / 4);
    EXPECT_EQ(on_small_face, 1);
    smallest = on_floor;
  }
}

// Law that allows the reuse of exchange areas: a patch with an earlier place is the same to the last bit.
TEST(NestedMesh, PatchesWithAPlaceAreTheSameAsBefore) {
  const Scene scene = test::furnished_room(0.5);
  NestedMesh mesh = nest(mesh_of(scene, 1));
  for (std::uint64_t round = 0; round < 3; ++round) {
    const std::vector<std::uint8_t> marks = some_parents(mesh, round);
    const FinerMesh finer = refine(mesh, marks);
    std::vector<int> taken(mesh.patches.size(), 0);
    for (PatchIndex i = 0; i < finer.mesh.patches.size(); ++i) {
      const PatchIndex before = finer.place[i];
      if (before == no_patch) continue;
      ++taken[before];
      EXPECT_TRUE(same_corners(finer.mesh.patches, i, mesh.patches, before));
      EXPECT_EQ(finer.mesh.patches.area[i], mesh.patches.area[before]);
      EXPECT_EQ(finer.mesh.patches.polygon[i], mesh.patches.polygon[before]);
    }
    EXPECT_LE(*std::max_element(taken.begin(), taken.end()), 1);
    // Marked parents are cut, and most of the others stay.
    for (PatchIndex i = 0; i < mesh.patches.size(); ++i) {
      EXPECT_TRUE(marks[mesh.parent[i]] == 0 || taken[i] == 0);
    }
    EXPECT_GT(2 * std::count(taken.begin(), taken.end(), 1), static_cast<long>(mesh.patches.size()));
    mesh = finer.mesh;
  }
}

// The first parent, of a floor, and the small face, which is whole and has parts after the first cut.
TEST(NestedMesh, PatchesAreCutAsOftenAsIsAskedFor) {
  constexpr double rounding = 1e-13;  // of hundreds of sums
  const NestedMesh mesh = nest(mesh_of(large_and_small(), 2));
  for (std::uint8_t cuts = 1; cuts <= 3; ++cuts) {
    std::vector<std::uint8_t> of_parents(mesh.parents.size(), 0);
    const auto small = static_cast<PatchIndex>(std::find(mesh.parents.polygon.begin(), mesh.parents.polygon.end(), 1U) -
                                               mesh.parents.polygon.begin());
    of_parents[0] = of_parents[small] = cuts;
    const FinerMesh finer = cut_patches(mesh, of_parents);
    expect_consistent(finer.mesh);
    const double parts = std::ldexp(1.0, 2 * cuts);
    std::vector<double> within(mesh.parents.size(), 0);
    for (PatchIndex i = 0; i < finer.mesh.patches.size(); ++i) {
      const double area = finer.mesh.patches.area[i];
      within[finer.parent_before[i]] += area;
      if (of_parents[finer.parent_before[i]] == 0) continue;
      EXPECT_EQ(finer.place[i], no_patch);
      const double before = mesh.parents.area[finer.parent_before[i]];
      const double expected = finer.parent_before[i] == small ? before / parts : before / (4 * parts);
      EXPECT_NEAR(area, expected, rounding * expected);
    }
    for (PatchIndex g = 0; g < mesh.parents.size(); ++g)
      EXPECT_NEAR(within[g], mesh.parents.area[g], rounding * mesh.parents.area[g]);
  }
}

TEST(NestedMesh, MeansAreByArea) {
  const NestedMesh mesh = nest(mesh_of(large_and_small(), 0.7));
  const Eigen::VectorXd area = areas(mesh.patches);
  Field values(mesh.patches.size(), 2);
  for (PatchIndex i = 0; i < mesh.patches.size(); ++i) values.row(i) << 1 + i % 5, 3;
  const Field means = means_by_parent(mesh, values, area);
  // Values that are spread over the patches and summed again give area times mean, within a few roundings of values up
  // to 5.
  const Field back = summed_by_parent(mesh, of_parents(mesh, means).colwise() * area.array());
  const Field sums = summed_by_parent(mesh, values.colwise() * area.array());
  EXPECT_LT((back - sums).abs().maxCoeff(), 20 * std::numeric_limits<double>::epsilon());
  EXPECT_LT((means.col(1) - 3).abs().maxCoeff(), 10 * std::numeric_limits<double>::epsilon());
  EXPECT_GT((means.col(0) - 3).abs().maxCoeff(), 0.1);
}

}  // namespace
}  // namespace patchlight::nested_mesh_test
