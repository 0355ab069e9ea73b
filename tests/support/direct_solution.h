#pragma once

#include "patchlight/solve/problem.h"
#include "patchlight/transport/transport_operator.h"

#include <Eigen/LU>

// The reference for all solvers: dense LU of I - R F.
namespace patchlight::test {

inline Field direct_solution(const TransportOperator& transport, const RadiosityProblem& problem) {
  const Eigen::Index n = problem.exitance.rows();
  const Field identity = Eigen::MatrixXd::Identity(n, n).array();
  const Eigen::MatrixXd F = transport.apply(identity).matrix();
  Field B(n, problem.exitance.cols());
  for (Eigen::Index band = 0; band < B.cols(); ++band) {
    const Eigen::MatrixXd system =
        Eigen::MatrixXd::Identity(n, n) - problem.scattering.reflectance.col(band).matrix().asDiagonal() * F;
    B.col(band) = system.partialPivLu().solve(problem.exitance.col(band).matrix()).array();
  }
  return B;
}

}  // namespace patchlight::test
