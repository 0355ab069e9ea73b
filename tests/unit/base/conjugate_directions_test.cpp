#include "base/vectors.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace patchlight::conjugate_directions_test {
namespace {

constexpr Eigen::Index n = 6;

// A symmetric positive definite matrix whose diagonal entries differ widely.
Eigen::MatrixXd system() {
  Eigen::MatrixXd A = Eigen::MatrixXd::Constant(n, n, 0.5);
  for (Eigen::Index i = 0; i < n; ++i) A(i, i) = 1 + static_cast<double>(i * i);
  return A;
}

Eigen::VectorXd right_side() { return Eigen::VectorXd::LinSpaced(n, -1, 2); }

Eigen::VectorXd solution(const ConjugateDirections<Eigen::VectorXd>::Preconditioner& preconditioner) {
  ConjugateDirections<Eigen::VectorXd> method(right_side(), preconditioner);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd q = system() * method.direction();
    const double step = method.length(q);
    x += step * method.direction();
    method.advance(q, step);
  }
  EXPECT_LT(method.residual().norm(), 1e-12);
  return x;
}

// Without rounding the n-th iterate solves a system of n unknowns. The condition number here is about 40.
TEST(ConjugateDirections, SolveInAsManyStepsAsThereAreUnknowns) {
  const Eigen::VectorXd exact = system().partialPivLu().solve(right_side());
  const Eigen::VectorXd diagonal = system().diagonal();
  EXPECT_LT((solution({}) - exact).norm(), 1e-12);
  const auto by_diagonal = [&](const Eigen::VectorXd& r) -> Eigen::VectorXd { return r.cwiseQuotient(diagonal); };
  EXPECT_LT((solution(by_diagonal) - exact).norm(), 1e-12);
}

// Each direction is conjugate to the earlier ones: p_k . A p_l = 0.
TEST(ConjugateDirections, AreConjugate) {
  ConjugateDirections<Eigen::VectorXd> method(right_side());
  const Eigen::VectorXd first = method.direction();
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd q = system() * method.direction();
    method.advance(q, method.length(q));
    EXPECT_NEAR(first.dot(system() * method.direction()), 0, 1e-12);
  }
}

// Bands are independent: a solved one takes no step, and the other is solved as if alone.
TEST(ConjugateDirections, OfBandsDoNotMix) {
  Field residual = Field::Zero(n, 2);
  residual.col(1) = right_side().array();
  ConjugateDirections<Field> method(residual);
  Field x = Field::Zero(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Field q = (system() * method.direction().matrix()).array();
    const Eigen::ArrayXd step = method.length(q);
    x += scaled(method.direction(), step);
    method.advance(q, step);
  }
  EXPECT_TRUE((x.col(0) == 0).all());
  EXPECT_LT((x.col(1).matrix() - solution({})).norm(), 1e-12);
}

}  // namespace
}  // namespace patchlight::conjugate_directions_test
