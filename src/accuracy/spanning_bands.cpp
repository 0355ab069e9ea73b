#include "accuracy/spanning_bands.h"

#include "solve/scattering.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>

namespace patchlight {
namespace {

// Fewer bands are not worth finding out about.
constexpr Eigen::Index few_bands = 3;

// x_a . x_b of bands that have norm 1, or 0 where all is 0.
Eigen::MatrixXd cosines_between(const FieldView& field, const Eigen::VectorXd& area, Eigen::VectorXd& norm) {
  const Eigen::MatrixXd weighed = (field.colwise() * area.array().sqrt()).matrix();
  norm = weighed.colwise().norm();
  const Eigen::VectorXd inverse = (norm.array() > 0).select(norm.array().inverse(), 0.0);
  return inverse.asDiagonal() * (weighed.transpose() * weighed) * inverse.asDiagonal();
}

// Bands by pivoted Cholesky decomposition: each time the one that those before tell least of, until they tell all but
// `tolerance` of every one.
std::vector<Eigen::Index> pivots(const Eigen::MatrixXd& G, double tolerance) {
  Eigen::VectorXd left = G.diagonal();  // squares of what the chosen ones do not tell
  Eigen::MatrixXd L(G.rows(), 0);
  std::vector<Eigen::Index> chosen;
  Eigen::Index next = 0;
  while (left.maxCoeff(&next) > tolerance * tolerance) {
    const Eigen::VectorXd column = (G.col(next) - L * L.row(next).transpose()) / std::sqrt(left[next]);
    L.conservativeResize(Eigen::NoChange, L.cols() + 1);
    L.rightCols(1) = column;
    left -= column.cwiseAbs2();
    left[next] = 0;
    chosen.push_back(next);
  }
  return chosen;
}

SpanningBands each_its_own(Eigen::Index bands) {
  SpanningBands spanning;
  for (Eigen::Index band = 0; band < bands; ++band) spanning.bands.push_back(band);
  spanning.weights = Eigen::MatrixXd::Identity(bands, bands);
  return spanning;
}

}  // namespace

Field SpanningBands::of(const FieldView& field) const {
  Field columns(field.rows(), static_cast<Eigen::Index>(bands.size()));
  for (Eigen::Index k = 0; k < columns.cols(); ++k) columns.col(k) = field.col(bands[static_cast<std::size_t>(k)]);
  return columns;
}

Field SpanningBands::all_bands(const FieldView& in_bands) const {
  assert(in_bands.cols() == weights.rows());
  return spans_all() ? Field(in_bands) : Field(in_bands.matrix() * weights);
}

SpanningBands spanning_bands(const FieldView& field, const Eigen::VectorXd& area, double tolerance) {
  SpanningBands spanning;
  if (field.cols() <= few_bands) return each_its_own(field.cols());
  // 1. Which.
  Eigen::VectorXd norm;
  const Eigen::MatrixXd G = cosines_between(field, area, norm);
  spanning.bands = pivots(G, tolerance);

  if (spanning.bands.size() == static_cast<std::size_t>(field.cols())) return each_its_own(field.cols());

  // 2. The combinations nearest to the others, by their normal equations.
  const auto count = static_cast<Eigen::Index>(spanning.bands.size());
  Eigen::MatrixXd of_chosen(count, count);
  Eigen::MatrixXd with_all(count, field.cols());
  for (Eigen::Index k = 0; k < count; ++k) with_all.row(k) = G.row(spanning.bands[static_cast<std::size_t>(k)]);
  for (Eigen::Index k = 0; k < count; ++k) of_chosen.col(k) = with_all.col(spanning.bands[static_cast<std::size_t>(k)]);
  spanning.weights = of_chosen.llt().solve(with_all) * norm.asDiagonal();
  for (Eigen::Index k = 0; k < count; ++k) spanning.weights.row(k) /= norm[spanning.bands[static_cast<std::size_t>(k)]];
  return spanning;
}

InNeededBands in_needed_bands(const SolvedProblem& solved) {
  const RadiosityProblem& problem = solved.problem;
  SolvedBands bands =
      solved_bands({problem.scattering, source_radiosity(problem), problem.area, problem.direct_irradiance});
  RadiosityProblem needed{of_bands(problem.scattering, bands.solved), reduced(problem.exitance, bands), problem.area,
                          reduced(problem.direct_irradiance, bands)};
  Solution solution;
  solution.radiosity = reduced(solved.solution.radiosity, bands);
  solution.irradiance = reduced(solved.solution.irradiance, bands);
  return {std::move(bands), std::move(needed), std::move(solution)};
}

}  // namespace patchlight
