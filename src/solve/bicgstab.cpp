#include "base/vectors.h"
#include "solve/krylov.h"

#include <utility>

namespace patchlight {

// On (I - K) B = E with the inner product sum_i A_i x_i y_i; names as in van der Vorst 1992.
Solution bicgstab(Iterations iterations) {
  const RadiosityProblem& problem = iterations.problem();
  const auto dot = [&](const Field& x, const Field& y) { return inner_product(x, y, problem.area); };
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  Field B = problem.exitance;
  Field H = iterations.direct_irradiance();
  Field r = problem.scattering.reflect(H);
  const Field shadow = r;
  Field p = r;
  Eigen::ArrayXd rho = dot(shadow, r);
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    // v = (I - K) p, s = r - alpha v
    const Field Hp = iterations.apply(p);
    const Field v = p - problem.scattering.reflect(Hp);
    const Eigen::ArrayXd alpha = quotient(rho, dot(shadow, v));
    const Field s = r - scaled(v, alpha);
    // t = (I - K) s, r = s - omega t
    const Field Hs = iterations.apply(s);
    const Field t = s - problem.scattering.reflect(Hs);
    const Eigen::ArrayXd omega = quotient(dot(t, s), dot(t, t));
    B += scaled(p, alpha) + scaled(s, omega);
    H += scaled(Hp, alpha) + scaled(Hs, omega);
    r = s - scaled(t, omega);
    const Eigen::ArrayXd rho_next = dot(shadow, r);
    const Eigen::ArrayXd beta = quotient(rho_next, rho) * quotient(alpha, omega);
    p = r + scaled(p - scaled(v, omega), beta);
    rho = rho_next;
    iterations.record(iterate_of(problem, B, H), k, Residual::recurred);
  }
  return iterations.finish();
}

}  // namespace patchlight
