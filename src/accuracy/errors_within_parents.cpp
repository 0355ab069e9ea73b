#include "accuracy/errors_within_parents.h"

#include "accuracy/refinement.h"
#include "mesh/means_around.h"

#include <cmath>
#include <cstddef>

namespace patchlight {

Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved) {
  const double scale = 1 / (std::pow(2.0, mesh_order) - 1);
  const Field difference = differences_from_parents(mesh, solved);
  const auto through_reflections = [&](std::size_t half) {
    return followed(transport, solved.problem, transport.apply_half(half, difference));
  };
  const Field square = through_reflections(0) * through_reflections(1);
  // Where the two differ in sign the error is not known any better than that.
  return scale * mean_around(mesh.patches, solved.problem.area, square).abs().sqrt();
}

}  // namespace patchlight
