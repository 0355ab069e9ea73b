#include "base/sampling.h"
#include "mesh/interpolate.h"
#include "mesh/mesher.h"
#include "mesh/nested_mesh.h"
#include "support/polygon_shapes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <optional>
#include <set>
#include <vector>

namespace patchlight::refine_test {
namespace {

// Shapes have a size of a few units, so a corner is known to about 1e-16, and an area to that times the perimeter.
constexpr double rounding = 1e-14;

// One in `rarity` patches.
std::vector<std::uint8_t> random_marks(const PatchMesh& mesh, std::uint64_t seed, std::uint32_t rarity) {
  std::vector<std::uint8_t> marks;
  for (PatchIndex i = 0; i < mesh.size(); ++i) marks.push_back(hash({seed, i}) % rarity == 0 ? 1 : 0);
  return marks;
}

// Refined at random this many times.
PatchMesh refined_at_random(PatchMesh mesh, int times) {
  for (int k = 0; k < times; ++k) mesh = refine(mesh, random_marks(mesh, static_cast<std::uint64_t>(k), 5)).mesh;
  return mesh;
}

double area_of(const PatchMesh& mesh, PatchRange range) {
  double sum = 0;
  for (PatchIndex i = range.begin; i < range.end; ++i) sum += mesh.area[i];
  return sum;
}

using Edge = std::array<std::uint32_t, 2>;

std::vector<Edge> edges_of(const PatchMesh& mesh, PatchIndex patch) {
  const auto count = static_cast<std::size_t>(mesh.corner_points(patch).count);
  std::vector<Edge> edges;
  for (std::size_t k = 0; k < count; ++k) {
    edges.push_back({mesh.corners[patch][k], mesh.corners[patch][(k + 1) % count]});
  }
  return edges;
}

std::set<std::uint32_t> vertices_of(const PatchMesh& mesh) {
  std::set<std::uint32_t> used;
  for (const auto& corners : mesh.corners) used.insert(corners.begin(), corners.end());
  return used;
}

// The position of a vertex between the ends of an edge, as a fraction. Empty if it is elsewhere.
std::optional<double> place_on(const PatchMesh& mesh, const Edge& edge, std::uint32_t vertex) {
  if (vertex == edge[0] || vertex == edge[1]) return std::nullopt;
  const Point& a = mesh.vertices[edge[0]];
  const Vector along = mesh.vertices[edge[1]] - a;
  const Vector to = mesh.vertices[vertex] - a;
  const double share = to.dot(along) / along.squaredNorm();
  const bool beside = (to - share * along).norm() > rounding;
  return beside || share < 1e-6 || share > 1 - 1e-6 ? std::nullopt : std::optional(share);
}

// The positions of vertices of patches that hang on an edge.
std::vector<double> hanging_on(const PatchMesh& mesh, const Edge& edge, const std::set<std::uint32_t>& vertices) {
  std::vector<double> places;
  for (const std::uint32_t vertex : vertices) {
    if (const auto place = place_on(mesh, edge, vertex)) places.push_back(*place);
  }
  return places;
}

// Shapes whose vertices differ by more than `rounding`, with a mesh each.
std::vector<std::pair<std::string, PatchMesh>> coarse_meshes() {
  std::vector<std::pair<std::string, PatchMesh>> meshes;
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    if (shape.thickness < 1) continue;
    meshes.emplace_back(shape.name, tessellate(shape.scene, tiny::front_sides(shape.scene), 0.7));
  }
  return meshes;
}

TEST(Refine, CutsEveryPatchIntoFourThatFillIt) {
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    const PatchMesh mesh = tessellate(shape.scene, tiny::both_sides(shape.scene), 0.7);
    const PatchMesh finer = refine(mesh);
    ASSERT_EQ(finer.size(), 4 * mesh.size()) << shape.name;
    for (PatchIndex i = 0; i < finer.size(); ++i) {
      const PatchIndex parent = i / 4;
      EXPECT_EQ(finer.polygon[i], mesh.polygon[parent]);
      EXPECT_EQ(finer.side[i], mesh.side[parent]);
      EXPECT_EQ(finer.material[i], mesh.material[parent]);
      EXPECT_EQ(finer.normal[i], mesh.normal[parent]);
      // Signed areas are positive and add up: the winding is the same, and there is no overlap.
      EXPECT_GT(area_vector(finer.corner_points(i)).dot(finer.normal[i]), 0);
      EXPECT_NEAR(area_of(finer, {4 * parent, 4 * parent + 4}), mesh.area[parent], rounding) << shape.name;
    }
  }
}

TEST(Refine, NothingMarkedChangesNothing) {
  for (const auto& [name, mesh] : coarse_meshes()) {
    const Refinement same = refine(mesh, std::vector<std::uint8_t>(mesh.size(), 0));
    EXPECT_EQ(same.mesh.vertices, mesh.vertices) << name;
    EXPECT_EQ(same.mesh.corners, mesh.corners) << name;
    EXPECT_EQ(same.mesh.middles.size(), 0U) << name;
    EXPECT_EQ(same.mesh.first_patch, mesh.first_patch) << name;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      EXPECT_EQ(same.parent[i], i);
      EXPECT_NEAR(same.mesh.area[i], mesh.area[i], rounding) << name;
      EXPECT_LT((same.mesh.centroid[i] - mesh.centroid[i]).norm(), rounding) << name;
    }
  }
}

TEST(Refine, PartsStandWhereTheirParentStood) {
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    PatchMesh mesh = tessellate(shape.scene, tiny::both_sides(shape.scene), 0.7);
    const double area = area_of(mesh, {0, mesh.size()});
    for (std::uint64_t round = 0; round < 4; ++round) {
      const std::vector<std::uint8_t> marks = random_marks(mesh, round, 5);
      const Refinement finer = refine(mesh, marks);
      ASSERT_TRUE(std::is_sorted(finer.parent.begin(), finer.parent.end()));
      for (PatchIndex i = 0; i < mesh.size(); ++i) {
        const auto parts = std::count(finer.parent.begin(), finer.parent.end(), i);
        EXPECT_EQ(parts == 4, parts != 1) << shape.name;
        EXPECT_TRUE(marks[i] == 0 || parts == 4);
      }
      for (const Side side : {Side::front, Side::back}) {
        const PatchRange range = finer.mesh.patches_on(0, side);
        for (PatchIndex i = range.begin; i < range.end; ++i) EXPECT_EQ(finer.mesh.side[i], side);
        // Each part of a cut patch has its own rounding.
        EXPECT_NEAR(area_of(finer.mesh, range), area / 2, rounding * std::sqrt(finer.mesh.size())) << shape.name;
      }
      mesh = finer.mesh;
    }
  }
}

// Law of balance, from the positions alone: at most one vertex hangs on an edge, in its middle.
TEST(Refine, NeighboursAreOneLevelApart) {
  for (const auto& [name, coarse] : coarse_meshes()) {
    const PatchMesh mesh = refined_at_random(coarse, 4);
    const std::set<std::uint32_t> vertices = vertices_of(mesh);
    int hanging = 0;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      for (const Edge& edge : edges_of(mesh, i)) {
        const std::vector<double> places = hanging_on(mesh, edge, vertices);
        ASSERT_LE(places.size(), 1U) << name;
        if (places.empty()) continue;
        EXPECT_NEAR(places[0], 0.5, rounding / (mesh.vertices[edge[0]] - mesh.vertices[edge[1]]).norm()) << name;
        ++hanging;
      }
    }
    EXPECT_GT(hanging, 0) << name;
  }
}

// Only necessary cuts: an edge of an unmarked cut patch has two vertices of other patches on it.
TEST(Refine, CutsBesidesTheMarkedOnlyWhatBalanceTakes) {
  int beside = 0;
  for (const auto& [name, coarse] : coarse_meshes()) {
    const PatchMesh mesh = refined_at_random(coarse, 2);
    const std::vector<std::uint8_t> marks = random_marks(mesh, 7, 11);
    const Refinement finer = refine(mesh, marks);
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      if (marks[i] != 0 || std::count(finer.parent.begin(), finer.parent.end(), i) == 1) continue;
      std::set<std::uint32_t> of_others;
      for (PatchIndex j = 0; j < finer.mesh.size(); ++j) {
        const auto& corners = finer.mesh.corners[j];
        if (finer.parent[j] != i) of_others.insert(corners.begin(), corners.end());
      }
      std::size_t most = 0;
      for (const Edge& edge : edges_of(mesh, i)) {
        most = std::max(most, hanging_on(finer.mesh, edge, of_others).size());
      }
      EXPECT_GE(most, 2U) << name;
      ++beside;
    }
  }
  EXPECT_GT(beside, 0);
}

// Sheets of any shape, even if only one side is marked.
TEST(Refine, CutsBothSidesOfASheetAlike) {
  for (const tiny::Shape& shape : tiny::polygon_shapes()) {
    if (shape.thickness < 1) continue;
    Scene scene = shape.scene;
    for (Material& material : scene.materials) material.diffuse_transmittance = Spectrum::Constant(1, 0.5);
    const PatchMesh mesh = refined_at_random(tessellate(scene, kept_sides(scene, Sides::both), 0.7), 4);
    EXPECT_EQ(mesh.sheets.size(), scene.polygons.size());
    const std::vector<PatchIndex> other_side = other_sides(mesh);
    ASSERT_EQ(other_side.size(), mesh.size()) << shape.name;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      ASSERT_NE(mesh.side[other_side[i]], mesh.side[i]) << shape.name;
      EXPECT_EQ(other_side[other_side[i]], i);
      EXPECT_EQ(mesh.polygon[other_side[i]], mesh.polygon[i]);
    }
  }
}

// A field drawn between vertices has no step at an edge with a hanging vertex.
TEST(Refine, HangingVerticesTakeTheMeanOfTheirEdge) {
  for (const auto& [name, coarse] : coarse_meshes()) {
    const PatchMesh mesh = refined_at_random(coarse, 4);
    Field values(mesh.size(), 2);
    CornerWeights weights(mesh.size(), 4);
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      for (Eigen::Index band = 0; band < 2; ++band)
        values(i, band) = 1 + hash({i, static_cast<std::uint64_t>(band)}) * 0x1p-32;
      weights.row(i).setConstant(mesh.area[i]);
    }
    const Field means = vertex_means(mesh, values, weights);
    const std::set<std::uint32_t> vertices = vertices_of(mesh);
    int hanging = 0;
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      for (const Edge& edge : edges_of(mesh, i)) {
        for (const std::uint32_t vertex : vertices) {
          if (!place_on(mesh, edge, vertex)) continue;
          const auto between = (means.row(edge[0]) + means.row(edge[1])) / 2;
          // One rounding of values up to 2.
          EXPECT_LT((means.row(vertex) - between).abs().maxCoeff(), 4 * std::numeric_limits<double>::epsilon()) << name;
          ++hanging;
        }
      }
    }
    EXPECT_GT(hanging, 0) << name;
  }
}

}  // namespace
}  // namespace patchlight::refine_test
