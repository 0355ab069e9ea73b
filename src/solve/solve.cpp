#include "patchlight/solve/solve.h"

#include "patchlight/solve/relaxation.h"
#include "patchlight/solve/southwell.h"

#include <cassert>

namespace patchlight {

const char* name_of(Solver solver) {
  switch (solver) {
    case Solver::jacobi:
      return "jacobi";
    case Solver::gauss_seidel:
      return "gauss-seidel";
    case Solver::progressive:
      return "progressive";
  }
  return "";
}

Eigen::ArrayXd area_norm(const FieldView& x, const Eigen::VectorXd& area) {
  return (x.square().colwise() * area.array()).colwise().sum().sqrt().transpose();
}

Solution solve(const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions& options,
               const Observer& observer) {
  assert(problem.exitance.rows() == static_cast<Eigen::Index>(transport.size()));
  assert(problem.reflectance.rows() == problem.exitance.rows() &&
         problem.reflectance.cols() == problem.exitance.cols());
  switch (options.solver) {
    case Solver::jacobi:
      return jacobi(transport, problem, options, observer);
    case Solver::gauss_seidel:
      return gauss_seidel(transport, problem, options, observer);
    case Solver::progressive:
      return progressive_refinement(transport, problem, options, observer);
  }
  return {};
}

}  // namespace patchlight
