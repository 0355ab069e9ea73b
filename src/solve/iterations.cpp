#include "solve/iterations.h"

#include "patchlight/base/error.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "base/vectors.h"
#include "solve/scattering.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace patchlight {
namespace {

// 0 / 0 is 0: nothing is wrong where there is nothing.
double ratio(double error, double size) { return error == 0 ? 0 : error / size; }

// The larger; not a number is worse than any.
double worse(double a, double b) { return std::isnan(a) || b <= a ? a : b; }

// The irradiance H for which an iterate is E + rho o H; F B where nothing is reflected.
Field arrived(const RadiosityProblem& problem, const Iterate& iterate) {
  return irradiance_behind(problem.scattering, iterate.radiosity - problem.exitance, iterate.irradiance);
}

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

// Sweeps from the first patch to the last. A sweep also computes F B of its starting values, so sweep k + 1 measures
// iterate k.
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

CoarseTransport::CoarseTransport(const RadiosityProblem& problem)
    : problem_(problem),
      patches_(problem.area.size()),
      groups_(std::min<Eigen::Index>(64, patches_)),
      arriving_(Eigen::MatrixXf::Zero(patches_, groups_)),
      arrived_(Eigen::VectorXd::Zero(groups_)),
      area_(Eigen::VectorXd::Zero(groups_)) {}

void CoarseTransport::learn(Eigen::Index source, const Field& shot_radiosity, const Field& arriving) {
  // A row of F is the same in all bands: the strongest one has the most digits.
  Eigen::Index band = 0;
  if (!(shot_radiosity.row(0).abs().maxCoeff(&band) > 0)) return;
  const Eigen::VectorXd row = arriving.col(band) / shot_radiosity(0, band);
  const Eigen::Index group = group_of(source);
  arriving_.col(group) += row.cast<float>();
  arrived_[group] += scalar_product(problem_.area, row);
  area_[group] += problem_.area[source];
}

Eigen::Index CoarseTransport::next_source(const Field& waiting) const {
  const Eigen::ArrayXd flux = waiting.abs().rowwise().sum() * problem_.area.array();
  Eigen::VectorXd of_unknown = Eigen::VectorXd::Zero(groups_);
  for (Eigen::Index i = 0; i < patches_; ++i) {
    if (area_[group_of(i)] == 0) of_unknown[group_of(i)] += flux[i];
  }
  Eigen::Index group = 0;
  const bool is_known = !(of_unknown.maxCoeff(&group) > 0);
  Eigen::Index source = 0;
  double most = -1;
  for (Eigen::Index i = 0; i < patches_; ++i) {
    if (!(flux[i] > most) || (!is_known && group_of(i) != group)) continue;
    most = flux[i];
    source = i;
  }
  return source;
}

Field CoarseTransport::ambient(const Field& unshot) const {
  // 1. Q_ig, the irradiance at patch i by unit flux of group g, is (arriving_ig + even) / weight_g. No more than all
  //    light arrives, sum_i A_i Q_ig <= 1, whatever the errors of the rows.
  const double mean_area = total(problem_.area) / static_cast<double>(patches_);
  const double arrived_share = total(area_) > 0 ? std::min(1.0, total(arrived_) / total(area_)) : 1;
  const double even = arrived_share / static_cast<double>(patches_);
  const Eigen::VectorXd weight = (area_.array() + mean_area).max(arrived_.array() + mean_area * arrived_share).matrix();

  const Field sent_back = problem_.scattering.reflect(problem_.area.array().replicate(1, unshot.cols()));  // A_i rho_i
  Field irradiance = Field::Zero(unshot.rows(), unshot.cols());
  for (Eigen::Index band = 0; band < unshot.cols(); ++band) {
    // 2. Flux of group h by unit flux of group g: T_hg = sum_i A_i rho_i Q_ig over the patches i of h.
    Eigen::VectorXd U = Eigen::VectorXd::Zero(groups_);
    Eigen::MatrixXd T = Eigen::MatrixXd::Zero(groups_, groups_);
    for (Eigen::Index i = 0; i < patches_; ++i) {
      U[group_of(i)] += problem_.area[i] * unshot(i, band);
      T.row(group_of(i)) += sent_back(i, band) * (arriving_.row(i).cast<double>().array() + even).matrix();
    }
    T.array().rowwise() /= weight.array().transpose();
    if (T.colwise().sum().maxCoeff() >= 1) continue;

    // 3. With all reflections the flux is (I - T)^-1 U; Q takes it to the patches.
    const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(groups_, groups_);
    const Eigen::VectorXd flux = (I - T).partialPivLu().solve(U).cwiseQuotient(weight);
    irradiance.col(band) = (arriving_ * flux.cast<float>()).cast<double>().array() + even * total(flux);
  }
  return irradiance;
}

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
    if (residual_norm[band] != 0) iteration.error_bound = no_bound;
  }
  return iteration;
}

Iteration Iterations::measured(const Iterate& iterate, int number) const {
  const Eigen::ArrayXd norm = area_norm(iterate.residual, problem_.area);
  const Eigen::ArrayXd reflected = area_norm(iterate.radiosity - emitted_, problem_.area);
  Iteration iteration = measured(norm, number);
  iteration.error_bound = 0;
  for (Eigen::Index band = 0; band < norm.size(); ++band) {
    double bound = no_bound;
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
  // Residuals fall by a constant factor, so their logarithm gives the completed fraction of the work.
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

// Marks the run as stopped, so that the observer is not called again.
void Iterations::stop() {
  if (!options_.keeps_unfinished || solution_.history.empty()) throw Canceled();
  solution_.stopped = true;
}

void Iterations::keep_observer() {
  if (!observer_ || solution_.stopped || wall_seconds() < next_report_) return;
  if (!observer_({.stage = Stage::solve, .fraction = fraction_})) stop();
  next_report_ = wall_seconds() + 0.1;
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

// No bound on the error follows from anything, and there is no reference.
bool Iterations::needs_norm_only() const {
  const bool some_contract = (bounds_.contraction < largest_contraction).any();
  return !some_contract && !bounds_.weights && !options_.reference;
}

// Returns false when it is not finite.
bool Iterations::put_into_history(const Iteration& iteration) {
  // Near rounding a residual that does not fall any more has come to its end.
  without_progress_ = iteration.relative_residual < least_residual_ / 2 ? 0 : without_progress_ + 1;
  least_residual_ = std::min(least_residual_, iteration.relative_residual);
  if (least_residual_ < tolerance_of_arithmetic && without_progress_ > 30) hopeless_ = true;
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
  const double radius = largest(iterations.spectral_radius(5));
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
  const Eigen::ArrayXd bound =
      iterations.bounds().contracts() ? iterations.bounds().contraction : iterations.spectral_radius(20);
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
