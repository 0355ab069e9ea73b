#include "accuracy/errors.h"
#include "base/vectors.h"
#include "mesh/interpolate.h"
#include "mesh/mesher.h"
#include "support/direct_solution.h"
#include "support/scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <utility>

namespace patchlight::errors_within_parents_test {
namespace {

using namespace test;

// Parents face each other closely in pairs. Each patch sees mainly the opposite one, and a little of all others.
RayTransport pairs_of_near_faces(const NestedMesh& mesh) {
  const PatchIndex size = mesh.patches.size();
  RayRows rows;
  rows.first_hit.assign(std::size_t{size} + 1, 0);
  rows.hit_weight.assign(size, 0);
  for (PatchIndex i = 0; i < size; ++i) {
    rows.first_entry.push_back(rows.entries.size());
    rows.entries.push_back({i ^ 4U, 0.9F});
    for (PatchIndex j = 0; j < size; ++j) {
      const double share = std::abs(std::sin(1.0 + 0.7 * i + 0.3 * j * j));
      rows.entries.push_back({j, static_cast<float>(0.09 / size * share)});
    }
  }
  rows.first_entry.push_back(rows.entries.size());
  return RayTransport({rows, rows});
}

// H = P F B.
struct OfParents : TransportOperator {
  OfParents(const NestedMesh& of, const TransportOperator& between, const Eigen::VectorXd& areas)
      : mesh(of), transport(between), area(areas) {}
  PatchIndex size() const override { return transport.size(); }
  Field apply(const FieldView& B) const override {
    return of_parents(mesh, means_by_parent(mesh, transport.apply(B), area));
  }
  const NestedMesh& mesh;
  const TransportOperator& transport;
  const Eigen::VectorXd& area;
};

// Theorem: if F has no errors, the result is F (B_h - B_2h) by Richardson's extrapolation. A direct solver computes
// both solutions. Light goes back and forth between patches so often that the differences within a parent would add up
// to eight times as much. The propagation of an error is solved to 5 %.
TEST(ErrorsWithinParents, AreTheDifferenceFromTheSolutionOnParents) {
  const Scene scene = cube_room(0.5, 0);
  const NestedMesh mesh = nest(tessellate(scene, kept_sides(scene, Sides::front), 0.5));
  const RayTransport transport = pairs_of_near_faces(mesh);
  const PatchIndex size = mesh.patches.size();
  ASSERT_EQ(mesh.parents.size(), size / 4);
  RadiosityProblem problem{
      {Field::Constant(size, 1, 0.97)}, Field::Zero(size, 1), Eigen::VectorXd::Map(mesh.patches.area.data(), size)};
  for (PatchIndex i = 0; i < size; ++i) problem.exitance(i, 0) = mesh.parent[i] % 5 == 0 ? 1 : 0;
  Solution solution;
  solution.radiosity = direct_solution(transport, problem);

  const Field larger = direct_solution(OfParents(mesh, transport, problem.area), problem);
  const Field difference = transport.apply(solution.radiosity - larger) / (std::pow(2.0, mesh_order) - 1);
  const Field expected = difference.abs().max(mean_around(mesh.patches, problem.area, difference.square()).sqrt());
  const Field found = errors_within_parents(mesh, transport, {problem, solution});
  EXPECT_LT(area_norm(found - expected, problem.area)[0], 0.05 * area_norm(expected, problem.area)[0]);
}

}  // namespace
}  // namespace patchlight::errors_within_parents_test
