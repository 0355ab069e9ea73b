#include "accuracy/errors_within_parents.h"

#include "accuracy/refinement.h"
#include "mesh/interpolate.h"

#include <cmath>
#include <cstddef>

namespace patchlight {
namespace {

// P x: the mean over the parent of each patch.
Field means_over_parents(const NestedMesh& mesh, const FieldView& x, const Eigen::VectorXd& area) {
  return of_parents(mesh, means_by_parent(mesh, x, area));
}

// H = P F B: light between patches twice as large, which know of what arrives nothing but its mean.
class ParentTransport : public TransportOperator {
 public:
  ParentTransport(const NestedMesh& mesh, const TransportOperator& of_patches, const Eigen::VectorXd& area)
      : mesh_(mesh), of_patches_(of_patches), area_(area) {}

  PatchIndex size() const override { return of_patches_.size(); }
  Field apply(const FieldView& radiosity) const override {
    return means_over_parents(mesh_, of_patches_.apply(radiosity), area_);
  }
  bool is_reciprocal() const override { return false; }

 private:
  const NestedMesh& mesh_;
  const TransportOperator& of_patches_;
  const Eigen::VectorXd& area_;
};

}  // namespace

Field errors_within_parents(const NestedMesh& mesh, const RayTransport& transport, const SolvedProblem& solved) {
  const double scale = 1 / (std::pow(2.0, mesh_order) - 1);
  const RadiosityProblem& problem = solved.problem;
  const Field difference = differences_from_parents(mesh, solved);
  const ParentTransport between_parents(mesh, transport, problem.area);
  // F (1 - P) B + F R e, e = P F (1 - P) B + P F R e.
  const auto through_reflections = [&](std::size_t half) -> Field {
    const Field straight = transport.apply_half(half, difference);
    const Field e = followed(between_parents, problem, means_over_parents(mesh, straight, problem.area));
    return straight + transport.apply(problem.scattering.reflect(e));
  };
  const Field square = through_reflections(0) * through_reflections(1);
  // Where the two differ in sign the error is not known any better than that.
  return scale * square.abs().max(mean_around(mesh.patches, problem.area, square).abs()).sqrt();
}

}  // namespace patchlight
