#include "patchlight/accuracy/error_bars.h"

#include <cassert>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

// Root mean squares over the patches of the same polygon side that share a vertex, the patch itself among them.
Field means_around(const PatchMesh& mesh, const Field& values) {
  std::vector<std::vector<PatchIndex>> at_vertex(mesh.vertices.size());
  const auto corners_of = [&](PatchIndex i) {
    return std::span(mesh.corners[i]).first(static_cast<std::size_t>(mesh.corner_points(i).count));
  };
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    for (const std::uint32_t vertex : corners_of(i)) at_vertex[vertex].push_back(i);
  }
  Field means(values.rows(), values.cols());
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    Field sum = Field::Zero(1, values.cols());
    double count = 0;
    for (const std::uint32_t vertex : corners_of(i)) {
      for (const PatchIndex j : at_vertex[vertex]) {
        if (mesh.polygon[j] != mesh.polygon[i]) continue;
        sum += values.row(j).square();
        ++count;
      }
    }
    means.row(i) = (sum / count).sqrt();
  }
  return means;
}

}  // namespace

Field mesh_errors(const NestedMesh& mesh, const SolvedProblem& solved, const FieldView& irradiance_of_parents) {
  const double scale = 1 / (std::pow(2.0, mesh_order) - 1);
  const Field means = means_by_parent(mesh, solved.solution.irradiance, solved.problem.area);
  const Field error = scale * (means - irradiance_of_parents).abs();
  return of_parents(mesh, error.max(means_around(mesh.parents, error)));
}

Field display_errors(const NestedMesh& mesh, const SolvedProblem& solved) {
  const Field& H = solved.solution.irradiance;
  const Eigen::VectorXd& area = solved.problem.area;
  const Field differences = H - of_parents(mesh, means_by_parent(mesh, H, area));
  const Field of_parts = means_by_parent(mesh, differences.square(), area).sqrt() / std::sqrt(3.0);
  return of_parents(mesh, means_around(mesh.parents, of_parts));
}

}  // namespace patchlight
