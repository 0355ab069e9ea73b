// Models that are tiny, huge or far from the origin, with degenerate faces or with reversed faces.
#include "patchlight/simulate.h"
#include "patchlight/transport/assemble.h"
#include "patchlight/transport/half_differences.h"

#include "form_factor/patch_shape.h"
#include "mesh/mesher.h"
#include "scene/repair.h"
#include "support/scenes.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::models_test {
namespace {

using namespace test;

Request coarse(double scale = 1) {
  Request request;
  request.mesh.max_edge = 0.5001 * scale;
  return request;
}

// A turned room; sizes of 4e-6 m and 4000 km; 1e6 m from the origin.
struct Placing {
  double scale;
  double shift;  // meters
};

class Placings : public testing::TestWithParam<Placing> {};

// The largest weight of a ray in units of the mean, for the pairs of this mesh.
constexpr double largest_weight = 2;

// The part of F_ij that one of n rays is worth, at most w_k / (n A_i). n is the usual number of samples times the
// effort, which an estimate of U may halve.
Eigen::MatrixXd worth_of_one_ray(const PatchMesh& mesh) {
  const std::vector<PatchShape> shapes = patch_shapes(mesh);
  Eigen::MatrixXd worth(mesh.size(), mesh.size());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (PatchIndex j = 0; j < mesh.size(); ++j) {
      const double U = i == j ? 0 : unoccluded_exchange_area(shapes[i], shapes[j]);
      const double rays = AssemblyOptions().samples * sampling_effort(U / std::min(mesh.area[i], mesh.area[j])) / 2.0;
      worth(i, j) = largest_weight * U / (rays * mesh.area[i]);
    }
  }
  return worth;
}

// F_ij does not depend on position, size and orientation. Random points are defined in the scene's own frames, so each
// pair gets the same rays. Most entries differ by rounding, 6e-8 F in single precision. By rounding, rays also pass
// edges 1e-7 of the extent nearer or farther. So about one ray in three million arrives in only one of the scenes. Each
// has four million rays; eight pairs allow for chance.
TEST_P(Placings, FormFactorsAreTheSame) {
  const Placing placing = GetParam();
  Eigen::Affine3d motion(Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()));
  motion = Eigen::Translation3d(placing.shift, -placing.shift, placing.shift) * motion * Eigen::Scaling(placing.scale);
  const auto mesh_of = [](const Scene& scene, double max_edge) {
    return tessellate(scene, kept_sides(scene, Sides::front), max_edge);
  };
  const auto form_factors = [&](const Scene& scene, double max_edge, std::uint64_t seed) -> Eigen::MatrixXd {
    const PatchMesh mesh = mesh_of(scene, max_edge);
    const ExchangeAreas S = assemble_exchange_areas(mesh, Occluder(scene), {.seed = seed}).exchange_areas;
    Eigen::MatrixXd F(mesh.size(), mesh.size());
    for (PatchIndex i = 0; i < mesh.size(); ++i) {
      for (PatchIndex j = 0; j < mesh.size(); ++j) F(i, j) = static_cast<double>(S.at(i, j)) / mesh.area[i];
    }
    return F;
  };
  const Scene room = repair(furnished_room(0.6));
  const Scene there = repair(moved(furnished_room(0.6), motion));
  const Eigen::MatrixXd one_ray = worth_of_one_ray(mesh_of(room, 0.5001));
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Eigen::MatrixXd expected = form_factors(room, 0.5001, seed);
    const Eigen::MatrixXd F = form_factors(there, 0.5001 * placing.scale, seed);
    ASSERT_EQ(F.rows(), expected.rows());
    EXPECT_GT(expected.maxCoeff(), 0.05);
    const Eigen::ArrayXXd apart = (F - expected).cwiseAbs().array();
    EXPECT_TRUE((apart < 1e-6 + one_ray.array()).all()) << seed;
    EXPECT_LE((apart >= 1e-6).count(), 2 * 8) << "both entries of a pair, seed " << seed;
  }

  const Simulation one = simulate(room, coarse());
  const Simulation other = simulate(there, coarse(placing.scale));
  EXPECT_EQ(other.solution.history.size(), one.solution.history.size());
  EXPECT_EQ(other.transport.counts.near_pairs, one.transport.counts.near_pairs);
  EXPECT_EQ(other.transport.closure, one.transport.closure);
}

INSTANTIATE_TEST_SUITE_P(SizesAndPlaces, Placings,
                         testing::Values(Placing{1, 0}, Placing{1e-6, 0}, Placing{1e6, 0}, Placing{1, 1e6},
                                         Placing{1e-6, 1}),
                         [](const auto& parameter) { return "placing_" + std::to_string(parameter.index); });

// Degenerate faces of every kind, and a repeated corner in each valid face, are dropped and counted. The result has the
// same bits except for the order of operations.
TEST(FacesWithoutArea, ChangeNothing) {
  const Scene sound = furnished_room(0.6);
  Scene scene = sound;
  for (Polygon& polygon : scene.polygons) polygon.corners.insert(polygon.corners.begin() + 1, polygon.corners[1]);
  scene = with_polygon(std::move(scene), {Point(1, 1, 1), Point(1, 1, 1), Point(1, 1, 1)});
  scene = with_polygon(std::move(scene), {Point(3, 1, 1), Point(3, 2, 1), Point(3, 1, 1)});
  scene = with_polygon(std::move(scene), {Point(0, 1, 1), Point(2, 1, 1), Point(4, 1, 1)});
  scene = with_polygon(std::move(scene), {Point(0, 0, 0), Point(4, 3, 0), Point(4, 3, 0), Point(2, 1.5, 0)});
  scene = with_polygon(std::move(scene), {Point(2, 2, 2), Point(2 + 1e-9, 2, 2), Point(2, 2 + 1e-9, 2)}, 1);
  scene = repair(std::move(scene));
  const auto count = [&](DiagnosticCode kind) {
    for (const Diagnostic& problem : scene.diagnostics) {
      if (problem.code == kind) return problem.count;
    }
    return std::size_t{0};
  };
  EXPECT_EQ(count(DiagnosticCode::zero_area), 5U);
  EXPECT_EQ(count(DiagnosticCode::repeated_corners), sound.polygons.size());
  const Field expected = simulate(repair(sound), coarse()).solution.radiosity;
  const Field radiosity = simulate(scene, coarse()).solution.radiosity;
  ASSERT_EQ(radiosity.rows(), expected.rows());
  EXPECT_LE((radiosity - expected).abs().maxCoeff(), 1e-12 * expected.maxCoeff());
}

// In a closed room with a box, any reversed face of a wall or the box is detected by its neighbors and reported. The
// light matches the correct room, up to rounding by the other order of corners.
TEST(TurnedFaces, OfClosedShellsChangeNothing) {
  const Scene sound = furnished_room(0.6);
  const Simulation expected = simulate(repair(sound), coarse());
  for (PolygonIndex turned = 0; turned < 12; ++turned) {
    Scene scene = sound;
    std::reverse(scene.polygons[turned].corners.begin() + 1, scene.polygons[turned].corners.end());
    scene = repair(std::move(scene));
    ASSERT_EQ(scene.diagnostics.size(), 1U) << turned;
    EXPECT_EQ(scene.diagnostics[0].code, DiagnosticCode::turned_faces);
    const Simulation simulation = simulate(scene, coarse());
    ASSERT_EQ(simulation.mesh.size(), expected.mesh.size()) << turned;
    EXPECT_NEAR(simulation.balance.absorbed[0], expected.balance.absorbed[0], 1e-6 * expected.balance.absorbed[0]);
    const double mean = expected.solution.irradiance.mean();
    EXPECT_NEAR(simulation.solution.irradiance.mean(), mean, 1e-2 * mean) << turned;
  }
}

// Three walls at one edge, a Moebius band, and a reversed face in an open shell are solved with both sides.
TEST(TurnedFaces, OfOpenShellsTakePartWithBothSides) {
  Scene fins = with_quad(empty_scene({grey(0.5), grey(0.2, 3)}),
                         {Point(-2, -2, 3), Point(-2, 2, 3), Point(2, 2, 3), Point(2, -2, 3)}, 1);
  Scene band = fins;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * M_PI * k / 3 + 0.1;
    const Vector out(std::cos(angle), std::sin(angle), 0);
    fins = with_quad(std::move(fins), {Point(0, 0, 0), Point(out), Point(out + Vector(0, 0, 1)), Point(0, 0, 1)});
  }
  const auto at = [](int k, double across) {
    const double angle = 2 * M_PI * k / 12;
    const Vector out(std::cos(angle), std::sin(angle), 0);
    return Point((1 + across * std::cos(angle / 2)) * out + across * std::sin(angle / 2) * Vector::UnitZ());
  };
  for (int k = 0; k < 12; ++k) {
    band = with_polygon(std::move(band), {at(k, -.3), at(k + 1, -.3), at(k + 1, .3)});
    band = with_polygon(std::move(band), {at(k, -.3), at(k + 1, .3), at(k, .3)});
  }
  for (const Scene& scene : {repair(fins), repair(band)}) {
    ASSERT_FALSE(scene.diagnostics.empty());
    const bool is_band = scene.polygons.size() > 4;
    EXPECT_EQ(scene.diagnostics[0].code, is_band ? DiagnosticCode::turned_faces : DiagnosticCode::non_manifold_edges);
    for (const Sides sides : {Sides::automatic, Sides::both}) {
      Request request = coarse();
      request.mesh.sides = sides;
      const Simulation simulation = simulate(scene, request);
      ASSERT_TRUE(simulation.solution.converged);
      EXPECT_LT(simulation.balance.imbalance, 1e-5);
      for (PolygonIndex p = 1; p < scene.polygons.size(); ++p) {
        for (const Side side : {Side::front, Side::back}) {
          const PatchRange range = simulation.mesh.patches_on(p, side);
          EXPECT_LT(range.begin, range.end) << "both sides of face " << p;
        }
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::models_test
