#include "form_factor/patch_cluster.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace patchlight::patch_cluster_test {
namespace {

using namespace test;

struct Clustered {
  PatchMesh mesh;
  std::vector<PatchShape> shapes;
  std::vector<PatchCluster> clusters;
};

// A room with a floating box and a floating triangle, far from the origin. It is rotated so that nothing is parallel to
// an axis.
Clustered clustered_room() {
  const Eigen::Affine3d motion =
      Eigen::Translation3d(1000, -2000, 500) * Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized());
  Scene scene = furnished_room(0.5);
  scene = with_polygon(std::move(scene), {Point(3, 2, 0.2), Point(3.8, 2.2, 0.1), Point(3.4, 2.8, 1)});
  scene = moved(std::move(scene), motion);
  Clustered room{tessellate(scene, kept_sides(scene, Sides::both), 0.35), {}, {}};
  room.shapes = patch_shapes(room.mesh);
  room.clusters = patch_clusters(room.mesh, room.shapes);
  return room;
}

TEST(PatchClusters, EveryPatchIsInOne) {
  const Clustered room = clustered_room();
  std::vector<int> found(room.mesh.size(), 0);
  for (const PatchCluster& cluster : room.clusters) {
    ASSERT_GE(cluster.size, 1);
    ASSERT_LE(cluster.size, Lanes::count);
    for (int lane = 0; lane < cluster.size; ++lane) ++found[cluster.patches[static_cast<std::size_t>(lane)]];
  }
  EXPECT_EQ(found, std::vector<int>(room.mesh.size(), 1));
  EXPECT_LT(room.clusters.size(), room.mesh.size() / 8) << "clusters are well filled";
}

TEST(PatchClusters, PlanarOnesLieInOnePlane) {
  const Clustered room = clustered_room();
  int planar = 0;
  for (const PatchCluster& cluster : room.clusters) {
    if (!cluster.is_planar) continue;
    ++planar;
    const PatchIndex first = cluster.patches[0];
    for (const PatchIndex patch : cluster.patches) {
      EXPECT_LT((room.mesh.normal[patch] - room.mesh.normal[first]).norm(), 1e-5);
      EXPECT_NEAR(room.mesh.normal[first].dot(room.mesh.centroid[patch] - room.mesh.centroid[first]), 0, 1e-5);
    }
  }
  EXPECT_GT(planar, 10);
}

// Rows agree with the double-precision value of each pair: to rounding where both use the same rule. If the distance is
// so close to a limit between rules that rounding decides, they agree to the rules' bound of 1e-3.
TEST(ClusterRow, IsTheUnoccludedExchangeArea) {
  const Clustered room = clustered_room();
  std::size_t compared = 0;
  std::size_t rounded = 0;
  for (const PatchCluster& a : room.clusters) {
    for (const PatchCluster& b : room.clusters) {
      for (int lane = 0; lane < a.size; ++lane) {
        const PatchShape& i = room.shapes[a.patches[static_cast<std::size_t>(lane)]];
        const ClusterRow row = cluster_row(a, lane, b);
        for (std::size_t k = 0; k < static_cast<std::size_t>(b.size); ++k) {
          const PatchShape& j = room.shapes[b.patches[k]];
          if (&i == &j || (row.exact >> k & 1) != 0) continue;
          const bool facing = orientation(i, j) != Orientation::averted;
          const double expected = facing ? unoccluded_exchange_area(i, j) : 0;
          if ((row.facing >> k & 1) == 0) {
            // Omitted pairs face away, or their angle is too small for single precision.
            ASSERT_LE(expected, 1e-6 * std::min(i.area, j.area));
            continue;
          }
          ASSERT_NEAR(row.unoccluded.at[k], expected, 1e-3 * expected + 1e-9 * i.area);
          ++compared;
          rounded += std::abs(row.unoccluded.at[k] - expected) <= 2e-5 * expected + 1e-9 * i.area ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(compared, 100000U);
  EXPECT_GT(static_cast<double>(rounded), 0.999 * static_cast<double>(compared));
}

// Two boxes of a hundred-thousandth of the room, two of their sizes apart, in clusters that span the room. Single
// precision would misplace their faces by 3e-3 of the distance.
TEST(ClusterRow, SmallThingsInWideClustersAreLeftToDoublePrecision) {
  Scene scene = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(10, 10, 10), true);
  for (const double x : {3.0, 3.0003}) {
    const Point corner(x, 7.1, 6.3);
    scene = with_box(std::move(scene), corner, corner + Vector(1e-4, 1e-4, 1e-4), false);
  }
  const PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), 20);
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  int decided = 0;
  for (const PatchCluster& a : patch_clusters(mesh, shapes)) {
    for (const PatchCluster& b : patch_clusters(mesh, shapes)) {
      for (int lane = 0; lane < a.size; ++lane) {
        const PatchIndex i = a.patches[static_cast<std::size_t>(lane)];
        const ClusterRow row = cluster_row(a, lane, b);
        for (std::size_t k = 0; k < static_cast<std::size_t>(b.size); ++k) {
          const PatchIndex j = b.patches[k];
          if (i == j || mesh.area[i] > 1 || mesh.area[j] > 1) continue;
          const bool is_exact = (row.exact >> k & 1) != 0;
          decided += is_exact ? 1 : 0;
          const bool facing = orientation(shapes[i], shapes[j]) != Orientation::averted;
          const double expected = facing ? unoccluded_exchange_area(shapes[i], shapes[j]) : 0;
          if (!is_exact) {
            ASSERT_NEAR(row.unoccluded.at[k], expected, 1e-3 * expected + 1e-9 * mesh.area[i]);
          }
        }
      }
    }
  }
  EXPECT_GT(decided, 0);
}

TEST(ClusterRow, IsTheSameFromBothSides) {
  const Clustered room = clustered_room();
  const PatchCluster& a = room.clusters.front();
  for (const PatchCluster& b : room.clusters) {
    for (int i = 0; i < a.size; ++i) {
      for (int j = 0; j < b.size; ++j) {
        const float there = cluster_row(a, i, b).unoccluded.at[static_cast<std::size_t>(j)];
        const float back = cluster_row(b, j, a).unoccluded.at[static_cast<std::size_t>(i)];
        ASSERT_NEAR(there, back, 1e-5F * there);
      }
    }
  }
}

TEST(ClusterRow, AvertedClustersHaveNoFacingPair) {
  const Clustered room = clustered_room();
  std::size_t found = 0;
  for (const PatchCluster& a : room.clusters) {
    for (const PatchCluster& b : room.clusters) {
      if (!averted(a, b)) continue;
      ++found;
      for (int lane = 0; lane < a.size; ++lane) {
        // A patch and its back, or itself, have no distance and are left to double precision.
        const ClusterRow row = cluster_row(a, lane, b);
        for (std::size_t k = 0; k < static_cast<std::size_t>(b.size); ++k) {
          const PatchIndex other = b.patches[k];
          const bool same_place =
              room.mesh.polygon[other] == room.mesh.polygon[a.patches[static_cast<std::size_t>(lane)]];
          ASSERT_TRUE((row.facing >> k & 1) == 0 || (same_place && (row.exact >> k & 1) != 0));
        }
      }
    }
  }
  EXPECT_GT(found, room.clusters.size());
}

}  // namespace
}  // namespace patchlight::patch_cluster_test
