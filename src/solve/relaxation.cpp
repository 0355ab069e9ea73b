#include "solve/relaxation.h"

#include "base/vectors.h"
#include "solve/scattering.h"

#include <cassert>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

enum class Order { forward, backward };

// B_i <- B_i + relaxation (E_i + rho_i H_i - B_i), patch by patch.
Relax relaxing(const RadiosityProblem& problem, double relaxation, Order order) {
  return [&problem, relaxation, order](const SweptPatches& patches) -> Field {
    const Eigen::Index rows = patches.radiosity.rows();
    Field change = Field::Zero(rows, patches.radiosity.cols());
    for (Eigen::Index k = 0; k < rows; ++k) {
      const Eigen::Index r = order == Order::forward ? k : rows - 1 - k;
      const Eigen::Index i = patches.range.begin + r;
      // The irradiance is by the old radiosities of these patches: add what those before have changed since.
      const Field H = patches.irradiance.row(r) + (patches.own_form_factors.row(r) * change.matrix()).array();
      change.row(r) =
          relaxation * (problem.exitance.row(i) + reflect_at(problem.scattering, i, H) - patches.radiosity.row(r));
    }
    return patches.radiosity + change;
  };
}

// Sweeps from the first patch to the last. A sweep also finds F B of what it starts from: iterate k is measured in
// sweep k + 1.
Solution swept(Iterations iterations, const RowTransport& transport, double relaxation) {
  const RadiosityProblem& problem = iterations.problem();
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  const Relax relax = relaxing(problem, relaxation, Order::forward);
  Sweep sweep = transport.sweep({problem.exitance, {}, {}}, relax, {});
  iterations.count(1);
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    Field B = sweep.radiosity;
    sweep = transport.sweep(std::move(sweep), relax, {});
    iterations.count(1);
    Field H = sweep.irradiance.size() > 0 ? std::move(sweep.irradiance) : iterations.apply(B);
    iterations.record(iterate_of(problem, std::move(B), std::move(H)), k);
  }
  return iterations.finish();
}

}  // namespace

Solution jacobi(Iterations iterations) {
  const RadiosityProblem& problem = iterations.problem();
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  Field H = iterations.direct_irradiance();
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    Field B = radiosity_from(problem, H);
    iterations.show_irradiance(std::move(H));
    H = iterations.apply(B);
    iterations.record(iterate_of(problem, std::move(B), H), k);
  }
  return iterations.finish();
}

Solution gauss_seidel(Iterations iterations, const RowTransport& transport) {
  return swept(std::move(iterations), transport, 1);
}

Solution sor(Iterations iterations, const RowTransport& transport) {
  const std::optional<double>& given = iterations.options().relaxation;
  if (given) return swept(std::move(iterations), transport, *given);
  // A few steps are enough: the factor hardly depends on the third digit.
  constexpr int steps = 5;
  const double radius = largest(iterations.spectral_radius(steps));
  return swept(std::move(iterations), transport, relaxation_for(radius));
}

Solution symmetric_gauss_seidel(Iterations iterations, const RowTransport& transport) {
  const RadiosityProblem& problem = iterations.problem();
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  const Relax there = relaxing(problem, 1, Order::forward);
  const Relax back = relaxing(problem, 1, Order::backward);
  Field B = problem.exitance;
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    B = transport.sweep({std::move(B), {}, {}}, there, back).radiosity;
    iterations.count(2);
    iterations.record(iterate_of(problem, B, iterations.apply(B)), k);
  }
  return iterations.finish();
}

// Golub and Varga 1961: x_k+1 = x_k-1 + omega_k+1 (r_k + x_k - x_k-1), the polynomials that are least on
// [-bound, bound]. All steps are taken on B and F B at once, by linearity.
Solution chebyshev(Iterations iterations) {
  const RadiosityProblem& problem = iterations.problem();
  constexpr int steps = 20;
  const Eigen::ArrayXd bound =
      iterations.bounds().contracts() ? iterations.bounds().contraction : iterations.spectral_radius(steps);
  if (iterations.start(iterations.apply(problem.exitance))) return iterations.finish();
  Field B = problem.exitance;
  Field before = B;
  Field H = iterations.direct_irradiance();
  Eigen::ArrayXd omega = Eigen::ArrayXd::Ones(bound.size());
  for (int k = 1; k <= iterations.options().max_iterations && !iterations.ended(); ++k) {
    if (k == 2) omega = 1 / (1 - bound.square() / 2);
    if (k > 2) omega = 1 / (1 - bound.square() * omega / 4);
    // E + K B_k, between that and B_k-1
    const Field next = before + scaled(radiosity_from(problem, H) - before, omega);
    before = std::move(B);
    B = next;
    H = iterations.apply(B);
    iterations.record(iterate_of(problem, B, H), k);
  }
  return iterations.finish();
}

double relaxation_for(double radius) {
  assert(radius >= 0);
  // ln(omega - 1) = omega radius (omega - 2) / (2 (omega - 1)), with the left side above the right below the root.
  double low = 1;
  double high = 2;
  for (int k = 0; k < 60; ++k) {
    const double omega = (low + high) / 2;
    const bool below = std::log(omega - 1) * 2 * (omega - 1) > omega * std::min(radius, 1.0) * (omega - 2);
    (below ? low : high) = omega;
  }
  return low;
}

}  // namespace patchlight
