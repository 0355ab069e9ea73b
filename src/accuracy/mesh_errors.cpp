#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"

#include <cmath>

namespace patchlight {

Field mesh_errors(const NestedMesh& mesh, const RowTransport& transport, const SolvedProblem& solved,
                  const FieldView& radiosity_of_parents) {
  const double scale = 1 / (std::pow(2.0, mesh_order) - 1);
  const Field difference = solved.solution.radiosity - of_parents(mesh, radiosity_of_parents);
  const Field error = scale * transport.apply(difference).abs();
  return error.max(means_around(mesh.patches, solved.problem.area, error));
}

Field display_errors(const NestedMesh& mesh, const SolvedProblem& solved) {
  const Field& H = solved.solution.irradiance;
  const Eigen::VectorXd& area = solved.problem.area;
  const Field differences = H - of_parents(mesh, means_by_parent(mesh, H, area));
  const Field of_parts = means_by_parent(mesh, differences.square(), area).sqrt() / std::sqrt(3.0);
  const Eigen::VectorXd of_parent = summed_by_parent(mesh, area.array()).col(0).matrix();
  return of_parents(mesh, means_around(mesh.parents, of_parent, of_parts));
}

}  // namespace patchlight
