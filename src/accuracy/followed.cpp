#include "patchlight/solve/solve.h"

#include "accuracy/errors.h"
#include "accuracy/spanning_bands.h"
#include "base/parallel.h"
#include "base/vectors.h"
#include "solve/scattering.h"

#include <Eigen/Cholesky>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// How far off what is followed may be, of what the reflections add to it.
constexpr double tolerance = 0.05;

// What bands that are solved leave out of those that they span: the others are combined, and checked.
constexpr double told = 0.3;

Solution solution_of(const TransportOperator& transport, const RadiosityProblem& problem,
                     std::optional<double> largest_row_sum) {
  // Few directions: by a million patches these are what takes most of the memory.
  return solve(transport, problem,
               {.solver = usual_solver(transport, problem),
                .relative_error = tolerance,
                .restart = 8,
                .largest_row_sum = largest_row_sum,
                .patch_bounds = false});
}

RadiosityProblem in_bands(const RadiosityProblem& problem, const std::vector<Eigen::Index>& bands) {
  Field exitance(problem.exitance.rows(), static_cast<Eigen::Index>(bands.size()));
  for (Eigen::Index k = 0; k < exitance.cols(); ++k)
    exitance.col(k) = problem.exitance.col(bands[static_cast<std::size_t>(k)]);
  return {of_bands(problem.scattering, bands), exitance, problem.area};
}

// Solutions y in some bands, with F y: what others may be combinations of.
struct KnownBands {
  Field radiosity;
  Field irradiance;
};

Field side_by_side(const Field& one, const Field& other) {
  Field both(other.rows(), one.cols() + other.cols());
  both << one, other;
  return both;
}

// Of all combinations of what is known the one with the least residual in a band, ||r||_A.
struct Combination {
  Eigen::ArrayXd irradiance;  // F y
  Eigen::ArrayXd residual;    // r = E + R F y - y
  bool is_good;               // ||r||_A / (1 - kappa) says that it is not too far off
};

Combination combined(const KnownBands& known, const RadiosityProblem& of_band, double kappa) {
  const Eigen::ArrayXd root = of_band.area.array().sqrt();
  const std::vector<Eigen::Index> repeated(static_cast<std::size_t>(known.radiosity.cols()), 0);
  const Field reflected = of_bands(of_band.scattering, repeated).reflect(known.irradiance);
  const Eigen::MatrixXd left = ((known.radiosity - reflected).colwise() * root).matrix();
  const Eigen::VectorXd right = (of_band.exitance.col(0) * root).matrix();
  const Eigen::VectorXd c = (left.transpose() * left).ldlt().solve(left.transpose() * right);
  const Eigen::VectorXd residual = right - left * c;
  const double added = ((known.radiosity.matrix() * c).array() * root - right.array()).matrix().norm();
  return {(known.irradiance.matrix() * c).array(), residual.array() / root,
          residual.norm() / (1 - kappa) <= tolerance * added};
}

// Light y = E + R F y in many bands, of which few are solved.
class InBands {
 public:
  InBands(const TransportOperator& transport, const RadiosityProblem& problem, double largest_row_sum)
      : transport_(transport),
        problem_(problem),
        row_sum_(largest_row_sum),
        kappa_(problem.scattering.norm_bound() * largest_row_sum),
        irradiance_(Field::Zero(problem.exitance.rows(), problem.exitance.cols())) {
    known_.radiosity = known_.irradiance = Field(problem.exitance.rows(), 0);
    for (Eigen::Index band = 0; band < problem.exitance.cols(); ++band) rest_.push_back(band);
  }

  // F y.
  Field irradiance();

 private:
  void solve_bands(const std::vector<Eigen::Index>& bands);
  Field combine_others();

  const TransportOperator& transport_;
  const RadiosityProblem& problem_;
  double row_sum_;
  Eigen::ArrayXd kappa_;
  KnownBands known_;
  Field irradiance_;
  std::vector<Eigen::Index> rest_;  // bands that are not found yet
};

void InBands::solve_bands(const std::vector<Eigen::Index>& bands) {
  const Field radiosity = solution_of(transport_, in_bands(problem_, bands), row_sum_).radiosity;
  const Field irradiance = transport_.apply(radiosity);
  for (std::size_t k = 0; k < bands.size(); ++k) {
    irradiance_.col(bands[k]) = irradiance.col(static_cast<Eigen::Index>(k));
    std::erase(rest_, bands[k]);
  }
  known_ = {side_by_side(known_.radiosity, radiosity), side_by_side(known_.irradiance, irradiance)};
}

// Finds what can be found from what is known; the residuals of the others.
Field InBands::combine_others() {
  Field residuals(problem_.exitance.rows(), static_cast<Eigen::Index>(rest_.size()));
  std::vector<std::uint8_t> found(rest_.size());
  parallel_for(rest_.size(), [&](std::size_t k) {
    const Combination of_band = combined(known_, in_bands(problem_, {rest_[k]}), kappa_[rest_[k]]);
    found[k] = of_band.is_good ? 1 : 0;
    if (of_band.is_good) irradiance_.col(rest_[k]) = of_band.irradiance;
    residuals.col(static_cast<Eigen::Index>(k)) = of_band.residual;
  });
  std::vector<Eigen::Index> left;
  std::vector<Eigen::Index> columns;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k] != 0) continue;
    left.push_back(rest_[k]);
    columns.push_back(static_cast<Eigen::Index>(k));
  }
  rest_ = std::move(left);
  return residuals(Eigen::all, columns);
}

// Bands that span the sources are solved first, then such as span what is missing yet in the others.
Field InBands::irradiance() {
  Field missing = problem_.exitance;
  while (!rest_.empty()) {
    std::vector<Eigen::Index> next = rest_;
    const SpanningBands spanning = spanning_bands(missing, problem_.area, told);
    // When half of the bands are solved so may be the rest.
    if (2 * (known_.radiosity.cols() + spanning.weights.rows()) <= irradiance_.cols()) {
      next.clear();
      for (const Eigen::Index k : spanning.bands) next.push_back(rest_[static_cast<std::size_t>(k)]);
    }
    if (next.empty()) next = rest_;
    solve_bands(next);
    missing = combine_others();
  }
  return std::move(irradiance_);
}

}  // namespace

Field followed(const TransportOperator& transport, const RadiosityProblem& problem, const Field& irradiance) {
  const RadiosityProblem of_irradiance{problem.scattering, problem.scattering.reflect(irradiance), problem.area};
  const auto directly = [&]() -> Field {
    return irradiance + solution_of(transport, of_irradiance, std::nullopt).irradiance;
  };
  constexpr Eigen::Index few_bands = 3;
  if (irradiance.cols() <= few_bands || !transport.is_reciprocal()) return directly();
  // Independent draws are no combinations of each other.
  const Eigen::Index spanning = spanning_bands(of_irradiance.exitance, problem.area, told).weights.rows();
  if (2 * spanning > irradiance.cols()) return directly();
  const double row_sum = highest(transport.apply(Field::Ones(irradiance.rows(), 1)))[0];
  if (!(problem.scattering.norm_bound().maxCoeff() * row_sum < 1)) return directly();
  return irradiance + InBands(transport, of_irradiance, row_sum).irradiance();
}

}  // namespace patchlight
