#include "patchlight/accuracy/error_bars.h"
#include "patchlight/solve/solve.h"

#include "accuracy/errors.h"
#include "base/conjugate_directions.h"
#include "mesh/means_around.h"
#include "solve/scattering.h"
#include "transport/random_errors.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Draws of the errors: a root mean square over eight is right to 25 %.
constexpr int draws = 8;
constexpr std::uint64_t seed = 1;

// A closed matrix has had its rows corrected by S_ij (lambda_i + lambda_j): the same for the draws. Solves
// (S + diag(S 1) (1 + damping)) lambda = -D 1 for every draw, by conjugate gradients with the diagonal as
// preconditioner. Damped, as the matrix is nearly singular where patches fall into two kinds that only see each other.
Field row_corrections(const RowTransport& transport, const Eigen::VectorXd& area, const Field& row_errors) {
  constexpr double tolerance = 1e-2;
  constexpr int most_iterations = 50;
  constexpr double damping = 0.02;
  const Eigen::ArrayXd A = area.array();
  const Field row_sum = transport.apply(Field::Ones(area.size(), 1)).colwise() * A;
  const Eigen::ArrayXd diagonal = row_sum.col(0).max(1e-12 * A);
  const Eigen::ArrayXd damped = (1 + damping) * diagonal;

  Field lambda = Field::Zero(row_errors.rows(), row_errors.cols());
  ConjugateDirections<Field> method(-row_errors, [&](const Field& r) -> Field { return r.colwise() / diagonal; });
  const Eigen::ArrayXd first = method.square();
  for (int k = 0; k < most_iterations && (method.square() > tolerance * tolerance * first).any(); ++k) {
    const Field& p = method.direction();
    const Field q = (transport.apply(p).colwise() * A) + (p.colwise() * damped);
    const Eigen::ArrayXd step = method.length(q);
    lambda += scaled(p, step);
    method.advance(q, step);
  }
  return lambda;
}

// One column of `field` per draw, `column` of each.
Field column_of_draws(const Field& field, Eigen::Index columns, Eigen::Index column) {
  Field column_of_each(field.rows(), field.cols() / columns);
  for (Eigen::Index draw = 0; draw < column_of_each.cols(); ++draw) {
    column_of_each.col(draw) = field.col(draw * columns + column);
  }
  return column_of_each;
}

}  // namespace

Field followed(const TransportOperator& transport, const RadiosityProblem& problem, const Field& irradiance) {
  const RadiosityProblem of_irradiance{problem.scattering, problem.scattering.reflect(irradiance), problem.area};
  // Few directions: by a million patches these are what takes most of the memory.
  const SolverOptions options{.solver = usual_solver(transport, problem), .relative_error = 0.05, .restart = 8};
  return irradiance + solve(transport, of_irradiance, options).irradiance;
}

Field form_factor_errors(const PatchMesh& mesh, const Assembly& raw, const RowTransport& transport,
                         const SolvedProblem& solved, const FieldView& B) {
  const RadiosityProblem& problem = solved.problem;
  const bool closed = solved.closed;
  const Eigen::Index bands = B.cols();
  const Eigen::ArrayXd A = problem.area.array();
  // 1. D B and D 1.
  Field x(B.rows(), bands + 1);
  x << B, Field::Ones(B.rows(), 1);
  const Field drawn = random_errors({mesh, problem.area, raw.entry_errors, raw.error}, x, draws, seed);
  const Field lambda = closed ? row_corrections(transport, problem.area, column_of_draws(drawn, bands + 1, bands))
                              : Field::Zero(B.rows(), draws);
  const Field H = closed ? transport.apply(B) : Field();

  Field squares = Field::Zero(B.rows(), bands);
  for (Eigen::Index band = 0; band < bands; ++band) {
    // 2. (D + S (lambda_i + lambda_j)) B = D B + lambda o (S B) + S (lambda o B), as irradiance.
    Field irradiance = column_of_draws(drawn, bands + 1, band).colwise() / A;
    if (closed) irradiance += lambda.colwise() * H.col(band) + transport.apply(lambda.colwise() * B.col(band));
    // 3. Through all reflections.
    const Scattering of_draws = of_bands(problem.scattering, std::vector<Eigen::Index>(draws, band));
    const Field e = followed(transport, {of_draws, {}, problem.area}, irradiance);
    squares.col(band) = e.square().rowwise().sum() / draws;
  }
  return squares.sqrt();
}

Field direct_light_errors(const PatchMesh& mesh, const RowTransport& transport, const RadiosityProblem& problem,
                          const FieldView& difference) {
  // Of two independent values each is off by a root of one half of their difference.
  const Field error = followed(transport, problem, difference / std::sqrt(2.0));
  return form_factor_scale * means_around(mesh, problem.area, error);
}

}  // namespace patchlight
