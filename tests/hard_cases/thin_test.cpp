// Thin gaps, boxes and slivers of 1e-4 to 1e-6 of their size, and the upper bounds of form factors.
#include "patchlight/transport/assemble.h"

#include "mesh/mesher.h"
#include "scene/repair.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace patchlight::thin_test {
namespace {

using namespace test;

struct Assembled {
  PatchMesh mesh;
  ExchangeAreas exchange_areas;
  Eigen::VectorXd row_sum;  // sum_j F_ij, before closure
};

Assembled assembled(const Scene& scene, double max_edge, const AssemblyOptions& options = {}) {
  PatchMesh mesh = tessellate(scene, kept_sides(scene, Sides::front), max_edge);
  ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene), options).exchange_areas;
  const Eigen::VectorXd area = Eigen::Map<const Eigen::VectorXd>(mesh.area.data(), mesh.size());
  Eigen::VectorXd sums = row_sums(S).cwiseQuotient(area);
  return {std::move(mesh), std::move(S), std::move(sums)};
}

// The identity, and rotations after which no coordinate is round.
std::vector<Eigen::Affine3d> turns(int count) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Affine3d> motions{Eigen::Affine3d::Identity()};
  for (int k = 1; k < count; ++k) {
    Eigen::Affine3d motion(
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized());
    motion.translation() = Vector(normal(random), normal(random), normal(random));
    motions.push_back(motion);
  }
  return motions;
}

Scene two_squares(double gap) {
  const Quad low{Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
  const Quad high{Point(0, 0, gap), Point(0, 1, gap), Point(1, 1, gap), Point(1, 0, gap)};
  return with_quad(with_quad(empty_scene({grey(0.5)}), low), high);
}

// Opposed squares of edge h with a gap g lose light through the gap. Along an edge of two long strips 1 - F = g / h
// (crossed strings), and there are two pairs of edges: 1 - F = 2 g / h + O((g / h)^2 ln). Patches of edge h in the
// middle lose nothing, so row sums lie in between.
TEST(ThinGap, SquaresSeeEachOtherBarTheGap) {
  for (const double gap : {1e-3, 1e-4, 1e-6}) {
    for (const Eigen::Affine3d& motion : turns(5)) {
      for (const double max_edge : {2.0, 0.1001}) {
        const Assembled result = assembled(moved(two_squares(gap), motion), max_edge);
        const double edge = std::min(1.0, max_edge);
        EXPECT_LT(result.row_sum.maxCoeff(), 1 + 1e-6);
        const double loss = (1 - result.row_sum.array()).maxCoeff();
        EXPECT_LT(loss, 2.1 * gap / edge + 1e-6);
        const double mean_loss = 1 - result.row_sum.mean();
        EXPECT_NEAR(mean_loss, 2 * gap, 0.1 * gap + 1e-6) << gap << " " << max_edge;
      }
    }
  }
}

// A closed box of small height: its row sums are 1, those of the plates within 1e-4, and none exceeds 1.001. Its walls
// are slivers of aspect 1 / height, whose own rows hold up to an aspect of 1e5, as below.
TEST(ThinGap, NoRowOfAThinBoxExceedsOne) {
  for (const double height : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const Scene box = with_box(empty_scene({grey(0.5)}), Point(0, 0, 0), Point(1, 1, height), true);
    for (const Eigen::Affine3d& motion : turns(5)) {
      for (const double max_edge : {2.0, 0.2501}) {
        const Assembled result = assembled(moved(box, motion), max_edge);
        EXPECT_LT(result.row_sum.maxCoeff(), 1.001);
        if (height >= 1e-5) {
          EXPECT_GT(result.row_sum.minCoeff(), 0.999);
        }
        for (PatchIndex i = 0; i < result.mesh.size(); ++i) {
          if (result.mesh.polygon[i] < 2) {
            EXPECT_NEAR(result.row_sum[i], 1, 1e-4) << height;
          }
        }
      }
    }
  }
}

// A unit cube whose floor is cut so that one piece is a sliver: a strip along a wall, a strip in the middle, or a
// triangle at a wall.
std::vector<Scene> rooms_with_sliver(double width) {
  Scene cube = cube_room(0.5, 1);
  cube.polygons.erase(cube.polygons.begin());
  const auto strip = [](Scene scene, double from, double to) {
    return with_quad(std::move(scene), {Point(from, 0, 0), Point(to, 0, 0), Point(to, 1, 0), Point(from, 1, 0)});
  };
  const Scene at_wall = strip(strip(cube, 0, width), width, 1);
  const Scene inside = strip(strip(strip(cube, 0, 0.4), 0.4, 0.4 + width), 0.4 + width, 1);
  const Scene triangle =
      with_polygon(with_polygon(cube, {Point(0, 0, 0), Point(1, 0, 0), Point(0.5, width, 0)}),
                   {Point(0, 0, 0), Point(0.5, width, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)});
  return {at_wall, inside, triangle};
}

// The contour integral of a sliver at a wall has an absolute error of 3e-9 of the room's area. Up to an aspect of 1e5
// this is within 1e-3 of the sliver's area.
TEST(Slivers, RowsOfARoomAddUpToOne) {
  for (const double width : {1e-2, 1e-4, 1e-5}) {
    for (const Scene& room : rooms_with_sliver(width)) {
      for (const Eigen::Affine3d& motion : turns(5)) {
        for (const double max_edge : {2.0, 0.2501}) {
          const Assembled result = assembled(moved(room, motion), max_edge);
          ASSERT_TRUE(result.row_sum.allFinite());
          EXPECT_LT((result.row_sum.array() - 1).abs().maxCoeff(), 1e-3) << width;
        }
      }
    }
  }
}

// Aspect 1e6, since repair removes thinner ones, with a box that hides some patches. All values are finite, and no row
// sum is off by more than a pair's sampling error of a few percent.
TEST(Slivers, AreFiniteAndBoundedBesideABox) {
  for (const double width : {1e-4, 1e-6}) {
    for (const Scene& room : rooms_with_sliver(width)) {
      const Scene furnished = with_box(room, Point(0.3, 0.3, 0.2), Point(0.7, 0.6, 0.5), false);
      for (const Eigen::Affine3d& motion : turns(3)) {
        const Assembled result = assembled(moved(furnished, motion), 0.2501);
        ASSERT_TRUE(result.row_sum.allFinite());
        EXPECT_LT((result.row_sum.array() - 1).abs().maxCoeff(), 0.05) << width;
      }
    }
  }
}

// Strips wider than the welding distance stay as they are in any orientation. Narrower ones are removed because they
// have no area, never because they cross themselves.
TEST(Slivers, AreKeptOrLeftOutByTheirWidthAlone) {
  for (const double width : {1e-4, 1e-5, 3e-6, 2e-6, 5e-7}) {
    for (const Scene& room : rooms_with_sliver(width)) {
      for (const Eigen::Affine3d& motion : turns(20)) {
        const Scene repaired = repair(moved(room, motion));
        for (const Diagnostic& problem : repaired.diagnostics) {
          EXPECT_TRUE(problem.code == DiagnosticCode::zero_area || problem.code == DiagnosticCode::welded_vertices)
              << name_of(problem.code);
        }
        const std::size_t lost = width < 1e-6 ? 1 : 0;
        EXPECT_EQ(repaired.polygons.size(), room.polygons.size() - lost) << width;
      }
    }
  }
}

// A_i F_ij <= min(A_i, A_j), as neither F_ij nor F_ji exceeds 1. Closed forms of touching patches meet it to 1e-6 of
// the larger patch's area; samples never exceed the unoccluded value.
TEST(Bounds, NoExchangeAreaExceedsTheSmallerPatch) {
  std::vector<Scene> scenes{furnished_room(0.5), two_squares(1e-3), two_squares(1e-6)};
  for (const double width : {1e-2, 1e-4, 1e-5}) {
    for (Scene& room : rooms_with_sliver(width)) scenes.push_back(std::move(room));
  }
  for (const Scene& scene : scenes) {
    for (const Eigen::Affine3d& motion : turns(3)) {
      const Assembled result = assembled(moved(scene, motion), 0.2501);
      const std::vector<double>& area = result.mesh.area;
      for (PatchIndex i = 0; i < result.mesh.size(); ++i) {
        for (PatchIndex j = 0; j < i; ++j) {
          ASSERT_LE(static_cast<double>(result.exchange_areas.at(i, j)), std::min(area[i], area[j]));
        }
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::thin_test
