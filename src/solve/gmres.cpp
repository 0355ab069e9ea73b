#include "base/vectors.h"
#include "solve/krylov.h"

#include <Eigen/QR>
#include <cstddef>
#include <span>
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

// The next direction: K v_k, orthogonalised, as the rest of (I - K) v_k lies along v_k; once more where nearly all of
// it was along the others, as then rounding leaves some of that, and twice is enough (Daniel, Gragg, Kaufman and
// Stewart 1976).
Arnoldi extended(Arnoldi arnoldi, const RadiosityProblem& problem, Field irradiance) {
  constexpr double much_is_left = 0.1;  // one digit of orthogonality at a step
  const auto k = static_cast<Eigen::Index>(arnoldi.irradiance.size());
  Field next = problem.scattering.reflect(irradiance);
  arnoldi.irradiance.push_back(std::move(irradiance));
  Eigen::ArrayXd before = area_norm(next, problem.area);
  Eigen::ArrayXd norm;
  Eigen::ArrayXXd along_all = Eigen::ArrayXXd::Zero(k + 1, next.cols());
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::ArrayXXd along = inner_products(next, arnoldi.v, problem.area);
    next = plus_combination(std::move(next), arnoldi.v, -along);
    along_all += along;
    norm = area_norm(next, problem.area);
    if ((norm >= much_is_left * before).all()) break;
    before = norm;
  }
  for (Eigen::Index band = 0; band < norm.size(); ++band) {
    Eigen::MatrixXd& hessenberg = arnoldi.hessenberg[static_cast<std::size_t>(band)];
    hessenberg.col(k).head(k + 1) = -along_all.col(band).matrix();
    hessenberg(k, k) += 1;
    hessenberg(k + 1, k) = -norm[band];
  }
  arnoldi.v.push_back(scaled(next, quotient(Eigen::ArrayXd::Ones(norm.size()), norm)));
  return arnoldi;
}

// The combination of the first k directions that has the least residual.
struct Least {
  Eigen::ArrayXXd lengths;       // k per band
  Eigen::ArrayXd residual_norm;  // ||r||_A per band
};

Least least_residual(const Arnoldi& arnoldi, Eigen::Index k) {
  Least least{Eigen::ArrayXXd(k, arnoldi.beta.size()), Eigen::ArrayXd(arnoldi.beta.size())};
  for (Eigen::Index band = 0; band < least.lengths.cols(); ++band) {
    const Eigen::MatrixXd hessenberg = arnoldi.hessenberg[static_cast<std::size_t>(band)].topLeftCorner(k + 1, k);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(k + 1);
    right[0] = arnoldi.beta[band];
    // Ranks are revealed: a band that is solved already has directions 0.
    const Eigen::VectorXd lengths = hessenberg.colPivHouseholderQr().solve(right);
    least.lengths.col(band) = lengths.array();
    least.residual_norm[band] = (right - hessenberg * lengths).norm();
  }
  return least;
}

// That combination, added to the start.
Iterate best(const Arnoldi& arnoldi, const RadiosityProblem& problem, const Iterate& start,
             const Eigen::ArrayXXd& lengths) {
  const auto k = static_cast<std::size_t>(lengths.rows());
  return iterate_of(problem, plus_combination(start.radiosity, std::span(arnoldi.v).first(k), lengths),
                    plus_combination(start.irradiance, std::span(arnoldi.irradiance).first(k), lengths));
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
    const Least least = least_residual(arnoldi, static_cast<Eigen::Index>(arnoldi.irradiance.size()));
    if (k % restart != 0) {
      iterations.record(
          least.residual_norm,
          [&arnoldi, &problem, &start, lengths = least.lengths] { return best(arnoldi, problem, start, lengths); }, k);
      continue;
    }
    // What was recorded before refers to the directions and the start until a newer iterate replaces it.
    Iterate next = best(arnoldi, problem, start, least.lengths);
    iterations.record(next, k, Residual::recurred);
    if (iterations.ended()) break;
    start = std::move(next);
    arnoldi = begun(problem, start.residual, restart);
  }
  return iterations.finish();
}

}  // namespace patchlight
