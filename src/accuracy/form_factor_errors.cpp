#include "patchlight/accuracy/error_bars.h"

#include "accuracy/errors.h"
#include "accuracy/spanning_bands.h"
#include "base/conjugate_directions.h"
#include "base/sampling.h"
#include "form_factor/patch_keys.h"
#include "mesh/interpolate.h"
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

// What draws of the errors change of the light, (D + S (lambda_i + lambda_j)) B = D B + lambda o (S B) + S (lambda o
// B), as irradiance.
struct Draws {
  const RowTransport& transport;
  const RadiosityProblem& problem;
  Field B;
  Field drawn;   // D B, a column for each band of B and one for D 1, for one draw after the other
  Field lambda;  // a column for each draw; none where nothing is closed
  Field H;       // F B, the same

  Field of_band(Eigen::Index band) const;
  Field of_draw(Eigen::Index draw) const;
};

// The changes of the irradiance in one band, by all draws.
Field Draws::of_band(Eigen::Index band) const {
  Field irradiance = column_of_draws(drawn, B.cols() + 1, band).colwise() / problem.area.array();
  if (lambda.size() > 0) irradiance += lambda.colwise() * H.col(band) + transport.apply(lambda.colwise() * B.col(band));
  return irradiance;
}

// The changes in all bands, by one draw.
Field Draws::of_draw(Eigen::Index draw) const {
  Field irradiance = drawn.middleCols(draw * (B.cols() + 1), B.cols()).colwise() / problem.area.array();
  if (lambda.size() > 0) irradiance += H.colwise() * lambda.col(draw) + transport.apply(B.colwise() * lambda.col(draw));
  return irradiance;
}

// Follows each draw through all reflections. Few bands are followed one by one. Many bands are followed by draws; the
// others are combinations of a few.
std::vector<Field> follow_draws(const Draws& draws_of, const SpanningBands& spanning) {
  const RadiosityProblem& problem = draws_of.problem;
  const Eigen::Index bands = problem.scattering.reflectance.cols();
  std::vector<Field> followed_draws(draws, Field(problem.area.size(), bands));
  if (spanning.spans_all()) {
    for (Eigen::Index band = 0; band < bands; ++band) {
      const Scattering of_draws = of_bands(problem.scattering, std::vector<Eigen::Index>(draws, band));
      const Field e = followed(draws_of.transport, {of_draws, {}, problem.area}, draws_of.of_band(band));
      for (std::size_t draw = 0; draw < draws; ++draw)
        followed_draws[draw].col(band) = e.col(static_cast<Eigen::Index>(draw));
    }
    return followed_draws;
  }
  for (std::size_t draw = 0; draw < draws; ++draw)
    followed_draws[draw] =
        followed(draws_of.transport, problem, spanning.all_bands(draws_of.of_draw(static_cast<Eigen::Index>(draw))));
  return followed_draws;
}

}  // namespace

Field mean_square(std::span<const Field> draws) {
  Field squares = draws.front().square();
  for (const Field& draw : draws.subspan(1)) squares += draw.square();
  return squares / static_cast<double>(draws.size());
}

std::vector<Field> draw_form_factor_errors(const PatchMesh& mesh, const Assembly& raw, const RowTransport& transport,
                                           const SolvedProblem& solved, const FieldView& B) {
  constexpr double told = 1e-3;  // of the light, by few bands: less than draws are sure of by far
  const RadiosityProblem& problem = solved.problem;
  const SpanningBands spanning = spanning_bands(B, problem.area, told);
  // 1. D B and D 1.
  const Field light = spanning.of(B);
  Field x(light.rows(), light.cols() + 1);
  x << light, Field::Ones(light.rows(), 1);
  Draws drawn{transport, problem,
              light,     random_errors({mesh, problem.area, raw.entry_errors, raw.error}, x, draws, seed),
              {},        {}};
  // 2. With rows closed.
  if (solved.closed) {
    drawn.lambda =
        row_corrections(transport, problem.area, column_of_draws(drawn.drawn, light.cols() + 1, light.cols()));
    drawn.H = transport.apply(light);
  }
  // 3. Through all reflections.
  return follow_draws(drawn, spanning);
}

Field direct_light_errors(const PatchMesh& mesh, const RowTransport& transport, const RadiosityProblem& problem,
                          const FieldView& difference) {
  // Of two independent values each is off by a root of one half of their difference.
  const Field error = followed(transport, problem, difference / std::sqrt(2.0));
  return form_factor_scale * means_around(mesh, problem.area, error);
}

std::vector<Field> draw_errors_of_lights(const PatchMesh& mesh, const RowTransport& transport,
                                         const RadiosityProblem& problem, const Field& standard_error) {
  if (standard_error.isZero(0)) return std::vector<Field>(draws, standard_error);
  const std::vector<std::uint32_t> keys = patch_keys(mesh);
  std::vector<Field> followed_draws;
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    Field error = standard_error;
    for (PatchIndex i = 0; i < mesh.size(); ++i)
      if ((hash({seed, keys[i], draw, 2}) & 1) != 0) error.row(i) *= -1;
    followed_draws.push_back(followed(transport, problem, error));
  }
  return followed_draws;
}

}  // namespace patchlight
