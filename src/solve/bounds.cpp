#include "solve/bounds.h"

#include "base/vectors.h"
#include "solve/iterations.h"
#include "solve/scattering.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

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
  const Eigen::Index bands = problem.exitance.cols();
  const auto norm_of = [&](const Field& h) {
    const Eigen::ArrayXd norm = reflected_square(problem.scattering, h, problem.area).max(0.0).sqrt();
    return Eigen::ArrayXd((norm > 1e-14).select(norm, 0.0));  // eigenvalues are at most 1: the space is exhausted
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

// No bounce that is left out of v may be above this one.
constexpr double last_bounce = 0.75;

// How many more bounces that takes if they go on falling as the last four did. Where this estimate is wrong, no bound
// is found.
double bounces_left(const std::vector<double>& highest_bounces) {
  if (highest_bounces.size() <= 4) return 0;
  const double now = highest_bounces.back();
  const double decay = std::log(highest_bounces[highest_bounces.size() - 5] / now) / 4;
  return decay > 0 ? std::log(now / last_bounce) / decay : no_bound;
}

constexpr int most_applications = 60;  // for weights

// v = 1 + K 1 + ... + K^n 1, Jacobi's iteration for v = 1 + K v, which leaves v - K v = 1 - K^(n+1) 1: for rows that
// are not reciprocal, and for sheets. It goes on until no K^(n+1) 1 is above 3/4, and is given up as soon as it will
// not get there. Where K 1 is the same everywhere, the bound does not depend on n.
PatchWeights weights_by_bounces(const TransportOperator& transport, const RadiosityProblem& problem) {
  PatchWeights weights{Field::Ones(problem.exitance.rows(), problem.exitance.cols()), {}, 0};
  Field bounce = weights.v;
  std::vector<double> highest_bounces{1};
  for (;;) {
    bounce = problem.scattering.reflect(transport.apply(bounce));
    ++weights.applications;
    highest_bounces.push_back(highest(bounce).maxCoeff());
    if (!(highest_bounces.back() > last_bounce) ||
        weights.applications + bounces_left(highest_bounces) >= most_applications)
      break;
    weights.v += bounce;
  }
  weights.g = 1 - bounce;
  return weights;
}

// The largest share that a patch scatters in any band: R of no band is above it.
Scattering of_brightest_bands(const Scattering& scattering) {
  Scattering highest{scattering.reflectance.rowwise().maxCoeff(), scattering.other_side, {}};
  if (!scattering.is_diagonal()) highest.transmittance = scattering.transmittance.rowwise().maxCoeff();
  return highest;
}

// 1 in the bands of this R.
RadiosityProblem glowing(const Scattering& scattering, const Eigen::VectorXd& area) {
  return {scattering, Field::Ones(scattering.reflectance.rows(), scattering.reflectance.cols()), area};
}

// v of a problem in which all patches emit 1, and g where it is known without another application.
PatchWeights loose_weights(const TransportOperator& transport, const RadiosityProblem& glowing) {
  if (!transport.is_reciprocal() || !glowing.scattering.is_diagonal()) return weights_by_bounces(transport, glowing);
  const auto [v, applications] = glowing_radiosity(transport, glowing, most_applications);
  return {v, {}, applications};
}

bool are_positive(const PatchWeights& weights) { return (weights.v > 0).all() && (weights.g > 0).all(); }

// Shared weights v for all bands, from an R at least as large as the R of each band. For no band is v - K v smaller
// than for that R.
PatchWeights shared_weights(const TransportOperator& transport, const RadiosityProblem& problem) {
  const Eigen::Index bands = problem.exitance.cols();
  const PatchWeights brightest =
      loose_weights(transport, glowing(of_brightest_bands(problem.scattering), problem.area));
  const Field irradiance = transport.apply(brightest.v).replicate(1, bands);
  const Field of_all = brightest.v.replicate(1, bands);
  return {of_all, of_all - problem.scattering.reflect(irradiance), brightest.applications + 1};
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
  // v = 1 + K v is the radiosity of patches that all emit 1; any approximation will do, of which g = v - K v > 0.
  int in_vain = 0;
  // With few bands each has weights of its own, which are tighter.
  if (problem.exitance.cols() > 3) {
    PatchWeights weights = shared_weights(transport, problem);
    if (are_positive(weights)) return weights;
    in_vain = weights.applications;
  }
  PatchWeights weights = loose_weights(transport, glowing(problem.scattering, problem.area));
  weights.applications += in_vain;
  if (weights.g.size() == 0) {
    weights.g = weights.v - problem.scattering.reflect(transport.apply(weights.v));
    ++weights.applications;
  }
  if (!are_positive(weights)) return std::nullopt;
  return weights;
}

Field patch_errors(const PatchWeights& weights, const FieldView& residual) {
  return scaled((weights.v - weights.g).max(0.0), highest(residual.abs() / weights.g));
}

std::string trapped_light(const TransportOperator& transport, const RadiosityProblem& problem) {
  if ((problem.scattering.norm_bound() < largest_contraction).all()) return {};
  // 1. Patches that lose light: they absorb, or some leaves.
  const Field row_sum = transport.apply(Field::Ones(transport.size(), 1));
  const Eigen::Index bands = problem.exitance.cols();
  const Field reflected = problem.scattering.reflect(Field::Ones(problem.exitance.rows(), bands));
  const auto keeps = (row_sum >= 1 - least_escape).replicate(1, bands);
  Field loses = (reflected < largest_contraction || !keeps).cast<double>();

  // 2. With them all from which light gets to them, bounce by bounce, as long as a lamp is among the others: that one
  //    would shine for ever.
  const auto lamps_among_others = [&]() -> Eigen::Index {
    return ((loses == 0) && (problem.exitance > 0)).rowwise().any().count();
  };
  Eigen::Index patches = lamps_among_others();
  for (bool grows = true; grows && patches > 0; patches = lamps_among_others()) {
    const Field wider = (loses > 0 || transport.apply(loses) > 0).cast<double>();
    grows = total(sum_over_patches(wider)) > total(sum_over_patches(loses));
    loses = wider;
  }
  if (patches == 0) return {};
  std::ostringstream text;
  text << "the light of " << patches << (patches == 1 ? " patch" : " patches")
       << " of lamps gets to surfaces only that reflect all of it, reflectance 1, and never out: it would grow without "
          "end. Lower a reflectance with read.settings, or open the room";
  return text.str();
}

}  // namespace patchlight
