#include "solve/iterations.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/vectors.h"
#include "solve/scattering.h"
#include "solve/spectral_radius.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

// 0 / 0 is 0: nothing is wrong where there is nothing.
double ratio(double error, double size) { return error == 0 ? 0 : error / size; }

// The larger; what is not a number is worse than any.
double worse(double a, double b) { return std::isnan(a) || b <= a ? a : b; }

// The irradiance H for which an iterate is E + rho o H; F B where nothing is reflected.
Field arrived(const RadiosityProblem& problem, const Iterate& iterate) {
  return irradiance_behind(problem.scattering, iterate.radiosity - problem.exitance, iterate.irradiance);
}

}  // namespace

Iterate iterate_of(const RadiosityProblem& problem, Field radiosity, Field irradiance) {
  Field residual = radiosity_from(problem, irradiance) - radiosity;
  return {std::move(radiosity), std::move(irradiance), std::move(residual)};
}

Iterations::Iterations(const TransportOperator& transport, const RadiosityProblem& problem,
                       const SolverOptions& options, const Observer& observer)
    : transport_(transport), problem_(problem), options_(options), observer_(observer), start_(wall_seconds()) {
  emitted_ = problem.exitance;
  if (problem.direct_irradiance.size() > 0) emitted_ -= problem.scattering.reflect(problem.direct_irradiance);
  bounds_.contraction = contraction_of(transport, problem, options);
  if (!options.largest_row_sum) count(1);
  if (!bounds_.contracts() && wants_weights()) bounds_.weights = patch_weights(transport, problem);
  if (bounds_.weights) count(bounds_.weights->applications);
}

// Not where a reference decides, nor where the transport is not to be applied as a whole.
bool Iterations::wants_weights() const {
  const bool known = !options_.largest_row_sum || std::isfinite(*options_.largest_row_sum);
  return known && !options_.reference;
}

Field Iterations::apply(const FieldView& radiosity) {
  count(1);
  return transport_.apply(radiosity);
}

Eigen::ArrayXd Iterations::spectral_radius(int steps) {
  count(steps);
  return patchlight::spectral_radius(transport_, problem_, steps);
}

// Nothing but the residual is known.
Iteration Iterations::measured(const Eigen::ArrayXd& residual_norm, int number) const {
  Iteration iteration{number, 0, 0, wall_seconds() - start_, work_};
  for (Eigen::Index band = 0; band < residual_norm.size(); ++band) {
    const double residual = ratio(residual_norm[band], first_residual_[band]);
    iteration.relative_residual = worse(iteration.relative_residual, residual);
    if (residual_norm[band] != 0) iteration.error_bound = unknown;
  }
  return iteration;
}

Iteration Iterations::measured(const Iterate& iterate, int number) const {
  const Eigen::ArrayXd norm = area_norm(iterate.residual, problem_.area);
  const Eigen::ArrayXd reflected = area_norm(iterate.radiosity - emitted_, problem_.area);
  Iteration iteration = measured(norm, number);
  iteration.error_bound = 0;
  for (Eigen::Index band = 0; band < norm.size(); ++band) {
    double bound = unknown;
    if (bounds_.contracts(band)) {
      bound = norm[band] / (1 - bounds_.contraction[band]);
    } else if (bounds_.weights) {
      const auto& [v, g, applications] = *bounds_.weights;
      bound = area_norm(v.col(band), problem_.area)[0] * highest(iterate.residual.col(band).abs() / g.col(band))[0];
    }
    if (norm[band] != 0) iteration.error_bound = worse(iteration.error_bound, bound / reflected[band]);
  }
  if (options_.reference) {
    const RadiosityProblem of_emitted{problem_.scattering, emitted_, problem_.area};
    iteration.true_error = relative_error(*options_.reference, iterate.radiosity, of_emitted);
  }
  return iteration;
}

// `irradiance` makes H_k where the observer asks for it.
void Iterations::tell(const std::function<Field()>& irradiance) {
  if (!observer_ || solution_.stopped) return;
  // Residuals fall by a constant factor: their logarithm tells the share of the work that is done.
  const Iteration& iteration = solution_.history.back();
  const double wanted = std::log(tolerance_of(options_));
  const double residual = std::isfinite(iteration.relative_residual) ? iteration.relative_residual : 1;
  const double reached = std::log(std::clamp(residual, tolerance_of(options_), 1.0));
  const Field* const ambient = ambient_.size() > 0 ? &ambient_ : nullptr;
  const double of_rows = options_.max_rows ? std::min(1.0, work_ / *options_.max_rows) : 0;
  fraction_ = std::max(reached / wanted, of_rows);
  const std::function<Field()> as_shown = [this] { return arrived_; };
  if (!observer_({Stage::solve, fraction_, &iteration, arrived_.size() > 0 ? as_shown : irradiance, ambient})) stop();
  arrived_.resize(0, 0);
}

// What stops is not asked again whether it should.
void Iterations::stop() {
  if (!options_.keeps_unfinished || solution_.history.empty()) throw Cancelled();
  solution_.stopped = true;
}

void Iterations::keep_observer() {
  constexpr double interval = 0.1;
  if (!observer_ || solution_.stopped || wall_seconds() < next_report_) return;
  if (!observer_({.stage = Stage::solve, .fraction = fraction_})) stop();
  next_report_ = wall_seconds() + interval;
}

bool Iterations::start(Field direct_irradiance) {
  solution_.direct_irradiance = std::move(direct_irradiance);
  Iterate lamps = iterate_of(problem_, problem_.exitance, solution_.direct_irradiance);
  first_residual_ = area_norm(lamps.residual, problem_.area);
  // The light of the lamps has arrived nowhere yet.
  show_irradiance(Field::Zero(problem_.exitance.rows(), problem_.exitance.cols()));
  return record(std::move(lamps), 0);
}

bool Iterations::is_good(const Iteration& iteration) const {
  if (options_.reference) return iteration.true_error <= tolerance_of(options_);
  const bool bounded = bounds_.contracts() || bounds_.weights;
  return (bounded ? iteration.error_bound : iteration.relative_residual) <= tolerance_of(options_);
}

bool Iterations::record(Iterate iterate, int number, Residual residual) {
  Iteration iteration = measured(iterate, number);
  solution_.converged = is_good(iteration);
  if (solution_.converged && residual == Residual::recurred && !options_.reference) {
    Field irradiance = apply(iterate.radiosity);
    iterate = iterate_of(problem_, std::move(iterate.radiosity), std::move(irradiance));
    iteration = measured(iterate, number);
    solution_.converged = is_good(iteration);
    // Recurrences go on falling when the residual itself has come down to rounding.
    hopeless_ = iteration.relative_residual > last_applied_residual_ / 2;
    last_applied_residual_ = iteration.relative_residual;
  }
  if (!put_into_history(iteration)) {
    // The last one with numbers is handed out; if there is none, the first.
    if (last_.irradiance.size() == 0 && !make_last_) last_ = std::move(iterate);
    return false;
  }
  tell([&] { return arrived(problem_, iterate); });
  last_ = std::move(iterate);
  make_last_ = {};
  return solution_.converged;
}

bool Iterations::record(const Eigen::ArrayXd& residual_norm, MakeIterate make, int number) {
  if (!needs_norm_only()) return record(make(), number, Residual::recurred);
  const Iteration iteration = measured(residual_norm, number);
  if (is_good(iteration)) return record(make(), number, Residual::recurred);
  if (!put_into_history(iteration)) return false;
  tell([&] { return arrived(problem_, make()); });
  make_last_ = std::move(make);
  return false;
}

// No bound on the error follows from anything, and no reference tells it.
bool Iterations::needs_norm_only() const {
  bool some_contract = false;
  for (Eigen::Index band = 0; band < bounds_.contraction.size(); ++band)
    some_contract = some_contract || bounds_.contracts(band);
  return !some_contract && !bounds_.weights && !options_.reference;
}

// True when it is finite. Tells whether it goes on.
bool Iterations::put_into_history(const Iteration& iteration) {
  // Near rounding a residual that does not fall any more has come to its end.
  constexpr double near_rounding = 1e-12;
  constexpr int patience = 30;
  without_progress_ = iteration.relative_residual < least_residual_ / 2 ? 0 : without_progress_ + 1;
  least_residual_ = std::min(least_residual_, iteration.relative_residual);
  if (least_residual_ < near_rounding && without_progress_ > patience) hopeless_ = true;
  solution_.history.push_back(iteration);
  const bool is_finite = std::isfinite(iteration.relative_residual);
  if (!is_finite) hopeless_ = true;
  return is_finite;
}

Solution Iterations::finish() {
  if (make_last_) last_ = make_last_();
  Solution solution = std::move(solution_);
  solution.irradiance = last_.irradiance;
  solution.radiosity = radiosity_from(problem_, last_.irradiance);
  solution.ambient = std::move(ambient_);
  if (options_.patch_bounds && !bounds_.weights && bounds_.contracts() && wants_weights())
    bounds_.weights = patch_weights(transport_, problem_);
  if (!bounds_.weights) return solution;
  solution.error = patch_errors(*bounds_.weights, last_.residual);
  const Eigen::ArrayXd error = area_norm(solution.error, problem_.area);
  const Eigen::ArrayXd reflected = area_norm(solution.radiosity - emitted_, problem_.area);
  solution.patch_bound = 0;
  for (Eigen::Index band = 0; band < error.size(); ++band) {
    solution.patch_bound = std::max(solution.patch_bound, ratio(error[band], reflected[band]));
  }
  return solution;
}

}  // namespace patchlight
