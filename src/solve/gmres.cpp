#include "base/vectors.h"
#include "solve/krylov.h"

#include <Eigen/QR>
#include <cstddef>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// One restart: directions v_1 ... v_m, orthonormal in sum_i A_i x_i y_i, with what they irradiate, and the Hessenberg
// matrices of I - K in them, one per band.
struct Arnoldi {
  std::vector<Field> v;           // radiosities
  std::vector<Field> irradiance;  // F v
  std::vector<Eigen::MatrixXd> hessenberg;
  Eigen::ArrayXd beta;  // ||r||_A at the start
};

Arnoldi begun(const RadiosityProblem& problem, const Field& residual, int restart) {
  Arnoldi arnoldi;
  arnoldi.beta = area_norm(residual, problem.area);
  const Eigen::ArrayXd ones = Eigen::ArrayXd::Ones(arnoldi.beta.size());
  arnoldi.v.push_back(scaled(residual, quotient(ones, arnoldi.beta)));
  arnoldi.hessenberg.assign(static_cast<std::size_t>(residual.cols()), Eigen::MatrixXd::Zero(restart + 1, restart));
  return arnoldi;
}

// The next direction: (I - K) v_k, orthogonalised twice (modified Gram-Schmidt loses orthogonality in one pass).
Arnoldi extended(Arnoldi arnoldi, const RadiosityProblem& problem, Field irradiance) {
  const auto k = static_cast<Eigen::Index>(arnoldi.irradiance.size());
  Field next = arnoldi.v.back() - problem.scattering.reflect(irradiance);
  arnoldi.irradiance.push_back(std::move(irradiance));
  for (int pass = 0; pass < 2; ++pass) {
    for (Eigen::Index j = 0; j <= k; ++j) {
      const Field& v = arnoldi.v[static_cast<std::size_t>(j)];
      const Eigen::ArrayXd h = inner_product(next, v, problem.area);
      next -= scaled(v, h);
      for (Eigen::Index band = 0; band < h.size(); ++band) arnoldi.hessenberg[band](j, k) += h[band];
    }
  }
  const Eigen::ArrayXd norm = area_norm(next, problem.area);
  for (Eigen::Index band = 0; band < norm.size(); ++band) arnoldi.hessenberg[band](k + 1, k) = norm[band];
  arnoldi.v.push_back(scaled(next, quotient(Eigen::ArrayXd::Ones(norm.size()), norm)));
  return arnoldi;
}

// The combination of the directions that has the least residual, added to the start.
Iterate best(const Arnoldi& arnoldi, const RadiosityProblem& problem, const Iterate& start) {
  const auto k = static_cast<Eigen::Index>(arnoldi.irradiance.size());
  Eigen::ArrayXXd lengths(start.radiosity.cols(), k);
  for (Eigen::Index band = 0; band < lengths.rows(); ++band) {
    const Eigen::MatrixXd hessenberg = arnoldi.hessenberg[static_cast<std::size_t>(band)].topLeftCorner(k + 1, k);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(k + 1);
    right[0] = arnoldi.beta[band];
    // Ranks are revealed: a band that is solved already has directions 0.
    lengths.row(band) = hessenberg.colPivHouseholderQr().solve(right).transpose().array();
  }
  Field B = start.radiosity;
  Field H = start.irradiance;
  for (Eigen::Index j = 0; j < k; ++j) {
    B += scaled(arnoldi.v[static_cast<std::size_t>(j)], lengths.col(j));
    H += scaled(arnoldi.irradiance[static_cast<std::size_t>(j)], lengths.col(j));
  }
  return iterate_of(problem, std::move(B), std::move(H));
}

}  // namespace

Solution gmres(Iterations iterations) {
  const RadiosityProblem& problem = iterations.problem();
  const int restart = iterations.options().restart;
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  Iterate start = iterate_of(problem, problem.exitance, iterations.direct_irradiance());
  Arnoldi arnoldi = begun(problem, start.residual, restart);
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    Field irradiance = iterations.apply(arnoldi.v.back());
    arnoldi = extended(std::move(arnoldi), problem, std::move(irradiance));
    const Iterate iterate = best(arnoldi, problem, start);
    iterations.record(iterate, k, Residual::recurred);
    if (k % restart != 0) continue;
    start = iterate;
    arnoldi = begun(problem, start.residual, restart);
  }
  return iterations.finish();
}

}  // namespace patchlight
