#include "solve/bounds.h"

#include "base/vectors.h"
#include "solve/krylov.h"

#include <limits>
#include <sstream>

namespace patchlight {
namespace {

// Row sums are known to about 1e-9: with ||K||_A above this nothing is known about the error.
constexpr double largest_contraction = 1 - 1e-8;

// Escape is what a row lacks to 1, beyond what closure leaves.
constexpr double least_escape = 1e-6;

constexpr double no_bound = std::numeric_limits<double>::infinity();

// v = 1 + K v by Jacobi's iteration, until no residual is above 1/2: for rows that are not reciprocal, and for sheets.
GlowingRadiosity glowing_by_bounces(const TransportOperator& transport, const RadiosityProblem& problem,
                                    int most_iterations) {
  const Field ones = Field::Ones(problem.exitance.rows(), problem.exitance.cols());
  GlowingRadiosity glowing{ones, 0};
  Field bounce = ones;
  while (glowing.applications < most_iterations && (bounce > 0.5).any()) {
    bounce = problem.scattering.reflect(transport.apply(bounce));
    glowing.radiosity += bounce;
    ++glowing.applications;
  }
  return glowing;
}

}  // namespace

bool Bounds::contracts(Eigen::Index band) const { return contraction[band] < largest_contraction; }

bool Bounds::contracts() const { return (contraction < largest_contraction).all(); }

Eigen::ArrayXd contraction_of(const TransportOperator& transport, const RadiosityProblem& problem,
                              const SolverOptions& options) {
  const Eigen::ArrayXd reflected = problem.scattering.norm_bound();
  // ||K||_A <= rho_max max_i sum_j F_ij where A^(1/2) F A^(-1/2) is symmetric: it is similar to F.
  if (!transport.is_reciprocal())
    return (reflected > 0).select(Eigen::ArrayXd::Constant(reflected.size(), no_bound), 0.0);
  const double row_sum = options.largest_row_sum ? *options.largest_row_sum
                                                 : highest(transport.apply(Field::Ones(transport.size(), 1)))[0];
  return (reflected > 0).select(reflected * row_sum, 0.0);
}

std::optional<PatchWeights> patch_weights(const TransportOperator& transport, const RadiosityProblem& problem) {
  // v = 1 + K v is the radiosity of patches that all emit 1; with the residual r of an approximation g = v - K v = 1 -
  // r.
  constexpr int most_iterations = 60;
  const Field ones = Field::Ones(problem.exitance.rows(), problem.exitance.cols());
  const RadiosityProblem glowing{problem.scattering, ones, problem.area};
  const bool is_symmetric = transport.is_reciprocal() && problem.scattering.is_diagonal();
  const auto [v, applications] = is_symmetric ? glowing_radiosity(transport, glowing, most_iterations)
                                              : glowing_by_bounces(transport, glowing, most_iterations);
  PatchWeights weights{v, v - problem.scattering.reflect(transport.apply(v)), applications + 1};
  if (!(weights.v > 0).all() || !(weights.g > 0).all()) return std::nullopt;
  return weights;
}

Field patch_errors(const PatchWeights& weights, const FieldView& residual) {
  return scaled((weights.v - weights.g).max(0.0), highest(residual.abs() / weights.g));
}

std::string trapped_light(const TransportOperator& transport, const RadiosityProblem& problem) {
  if ((problem.scattering.norm_bound() < 1).all()) return {};
  // 1. Patches that lose light: they absorb, or some leaves.
  const Field row_sum = transport.apply(Field::Ones(transport.size(), 1));
  const auto keeps = [&](Eigen::Index i) { return row_sum(i, 0) >= 1 - least_escape; };
  const Field reflected = problem.scattering.reflect(Field::Ones(problem.exitance.rows(), problem.exitance.cols()));
  Field loses = Field::Zero(problem.exitance.rows(), problem.exitance.cols());
  for (Eigen::Index i = 0; i < loses.rows(); ++i) {
    for (Eigen::Index band = 0; band < loses.cols(); ++band) {
      loses(i, band) = reflected(i, band) < 1 || !keeps(i) ? 1 : 0;
    }
  }

  // 2. With them all from which light gets to them, bounce by bounce.
  for (bool grows = true; grows;) {
    const Field wider = (loses > 0 || transport.apply(loses) > 0).cast<double>();
    grows = total(sum_over_patches(wider)) > total(sum_over_patches(loses));
    loses = wider;
  }

  // 3. A lamp among the others shines for ever.
  Eigen::Index patches = 0;
  for (Eigen::Index i = 0; i < loses.rows(); ++i) {
    patches += ((loses.row(i) == 0) && (problem.exitance.row(i) > 0)).any() ? 1 : 0;
  }
  if (patches == 0) return {};
  std::ostringstream text;
  text << "the light of " << patches << (patches == 1 ? " patch" : " patches")
       << " of lamps gets to surfaces only that reflect all of it, reflectance 1, and never out: it would grow without "
          "end. Lower a reflectance with read.settings, or open the room";
  return text.str();
}

}  // namespace patchlight
