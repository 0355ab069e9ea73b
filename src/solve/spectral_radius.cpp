#include "solve/spectral_radius.h"

#include "base/vectors.h"
#include "solve/scattering.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// With B = rho o h, h an irradiance, w = (A rho)^1/2 h: h <- F (rho o h) is w <- G w, and radius = ||G w|| / ||w||.
SpectralRadius by_power_iteration(const TransportOperator& transport, const RadiosityProblem& problem, int steps) {
  const auto squares = [&](const Field& h) { return reflected_square(problem.scattering, h, problem.area); };
  Field h = Field::Ones(problem.exitance.rows(), problem.exitance.cols());
  Eigen::ArrayXd radius = Eigen::ArrayXd::Zero(h.cols());
  Eigen::ArrayXd last = radius;
  for (int k = 0; k < steps; ++k) {
    const Field next = transport.apply(problem.scattering.reflect(h));
    const Eigen::ArrayXd before = squares(h);
    const Eigen::ArrayXd after = squares(next);
    last = radius;
    radius = (before > 0).select((after / before).sqrt(), 0.0);
    const Eigen::ArrayXd scale = (after > 0).select(after.sqrt().inverse(), 0.0);
    h = scaled(next, scale);
  }
  return {radius, (radius - last).abs()};
}

// A symmetric tridiagonal matrix for each band, a column each; the last row of `beside` is what comes after it.
struct Tridiagonal {
  Eigen::ArrayXXd diagonal, beside;
};

// The three-term recurrence of Lanczos (Golub and Van Loan 2013, algorithm 10.1.1) in the inner product
// <x, y> = sum_i A_i rho_i x_i y_i. Vectors are not made orthogonal again: the largest eigenvalue does not need it.
Tridiagonal lanczos(const TransportOperator& transport, const RadiosityProblem& problem, int steps) {
  constexpr double smallest = 1e-14;  // of eigenvalues of at most 1: the space is exhausted
  const Eigen::Index bands = problem.exitance.cols();
  const auto norm_of = [&](const Field& h) {
    const Eigen::ArrayXd norm = reflected_square(problem.scattering, h, problem.area).max(0.0).sqrt();
    return Eigen::ArrayXd((norm > smallest).select(norm, 0.0));
  };
  const auto unit = [](const Field& h, const Eigen::ArrayXd& norm) {
    return scaled(h, (norm > 0).select(norm.inverse(), 0.0));
  };
  Tridiagonal T{Eigen::ArrayXXd::Zero(steps, bands), Eigen::ArrayXXd::Zero(steps, bands)};
  Field h = Field::Ones(problem.exitance.rows(), bands);
  h = unit(h, norm_of(h));
  Field before = Field::Zero(h.rows(), bands);
  for (int k = 0; k < steps; ++k) {
    const Field reflected = problem.scattering.reflect(h);
    Field next = transport.apply(reflected);
    T.diagonal.row(k) = area_sum(next * reflected, problem.area).transpose();
    next -= scaled(h, T.diagonal.row(k).transpose());
    if (k > 0) next -= scaled(before, T.beside.row(k - 1).transpose());
    const Eigen::ArrayXd norm = norm_of(next);
    T.beside.row(k) = norm.transpose();
    before = std::move(h);
    h = unit(next, norm);
  }
  return T;
}

}  // namespace

SpectralRadius spectral_radius_with_error(const TransportOperator& transport, const RadiosityProblem& problem,
                                          int steps) {
  if (!problem.scattering.is_diagonal()) return by_power_iteration(transport, problem, steps);
  const Tridiagonal T = lanczos(transport, problem, steps);
  const Eigen::Index bands = T.diagonal.cols();
  SpectralRadius radius{Eigen::ArrayXd::Zero(bands), Eigen::ArrayXd::Zero(bands)};
  for (Eigen::Index band = 0; band < bands; ++band) {
    const Eigen::VectorXd beside = T.beside.col(band).head(steps - 1).matrix();
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    solver.computeFromTridiagonal(T.diagonal.col(band).matrix(), beside);
    Eigen::Index largest = 0;
    radius.value[band] = solver.eigenvalues().cwiseAbs().maxCoeff(&largest);
    // ||G y - theta y|| of the Ritz vector y.
    radius.error[band] = std::abs(T.beside(steps - 1, band) * solver.eigenvectors()(steps - 1, largest));
  }
  return radius;
}

Eigen::ArrayXd spectral_radius(const TransportOperator& transport, const RadiosityProblem& problem, int steps) {
  return spectral_radius_with_error(transport, problem, steps).value;
}

}  // namespace patchlight
