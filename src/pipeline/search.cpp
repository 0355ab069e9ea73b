#include "pipeline/search.h"

#include "patchlight/base/error.h"

#include "accuracy/errors.h"
#include "accuracy/refinement.h"
#include "base/parallel.h"
#include "base/rounded.h"
#include "mesh/nested_mesh.h"
#include "mesh/refine.h"
#include "pipeline/first_mesh.h"
#include "pipeline/relative_errors.h"
#include "pipeline/with_error_bars.h"
#include "plan/memory.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

// How an accuracy is shared out, in quadrature. The solver's bound for all patches together is asked to be a fiftieth,
// so that what it leaves to single patches is about a tenth.
constexpr double share_of_mesh = 0.7;
constexpr double share_of_form_factors = 0.6;
constexpr double share_of_solver = 0.02;

// What the solver may leave of the light that is of interest.
constexpr double share_of_interest = 0.1;

// Shadow rays of a pair, more than which are not worth their time.
constexpr int most_samples = 256;

// So many meshes at most.
constexpr int most_steps = 20;

// The number of patches for which the mesh error is expected to be `factor` times smaller.
double patches_for(double patches, double factor) { return patches * std::pow(std::max(1.0, factor), 2 / mesh_order); }

int next_samples(int samples, double factor) {
  const double needed = samples * factor * factor;
  int next = samples;
  while (next < needed && next < most_samples) next = std::min(2 * next, most_samples);
  return std::max(samples, next);
}

// What one error may be when the others are as they are: what they leave, but no less than its share.
double allowed(double accuracy, double share, double others) {
  return std::max(share * accuracy, std::sqrt(std::max(0.0, accuracy * accuracy - others * others)));
}

// Errors are brought this much lower than they have to be, as they are estimates, and enough is what is that much
// lower.
constexpr double error_margin = 1.25;
constexpr double enough = 1.1;

// By what factor the mesh error has to fall, and that of shadow rays towards luminaires, sun and sky, which are as
// many for every patch.
double mesh_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  const double lights = solved.light_bar;
  const double beside = std::sqrt(std::max(0.0, step.form_factor * step.form_factor - lights * lights));
  return error_margin * std::hypot(step.mesh, lights) /
         allowed(accuracy, share_of_mesh, std::hypot(beside, step.solver));
}

// What shadow rays err may be, when all else is as it is: mesh, solver, and what of the form factors' error has nothing
// to do with their samples.
double allowed_noise(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  const double noise = solved.noise_bar;
  const double beside = std::sqrt(std::max(0.0, step.form_factor * step.form_factor - noise * noise));
  return allowed(accuracy, share_of_form_factors, std::hypot(step.mesh, step.solver, beside));
}

// The factor by which the error has to fall.
double noise_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  return error_margin * solved.noise_bar / allowed_noise(solved, step, accuracy);
}

// It falls as one over the root of samples and patches: samples for those patches that the mesh will need. As long as
// that is far off, the usual number does.
int samples_for(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  constexpr double far_off = 1.5;
  if (mesh_factor(solved, step, accuracy) > far_off) return step.samples;
  const double patches = patches_for(step.patches, mesh_factor(solved, step, accuracy));
  const double factor = noise_factor(solved, step, accuracy) * std::sqrt(step.patches / patches);
  return factor > error_margin ? next_samples(step.samples, factor) : step.samples;
}

// Where few sources make most of the noise, as lamps do, they are cut: that samples them more, and leaves what is known
// of all other pairs. So many, as a share of all, are few.
constexpr double few = 0.25;

// Lamps are not cut into more patches than can be traced twice.
Eigen::VectorXd noise_to_cut(const SolvedMesh& solved) {
  Eigen::VectorXd noise = solved.noise;
  const RadiosityProblem& problem = solved.simulation.problem;
  if (4 * share_of_lamps(problem) < most_lamps) return noise;
  for (PatchIndex i = 0; i < solved.mesh.patches.size(); ++i) {
    if ((problem.exitance.row(i) > 0).any()) noise[solved.mesh.parent[i]] = 0;
  }
  return noise;
}

std::vector<std::uint8_t> either(std::vector<std::uint8_t> marks, const std::vector<std::uint8_t>& others) {
  for (std::size_t k = 0; k < marks.size(); ++k) marks[k] |= others[k];
  return marks;
}

std::size_t count(const std::vector<std::uint8_t>& marks) {
  return static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
}

// The pairs of patches that have to be found.
double new_pairs(const AccuracyStep& step) {
  const double all = step.patches;
  const double known = step.patches - step.new_patches;
  return all * all - known * known;
}

// The largest number of patches, new ones beside `known`, for which pairs take so many seconds.
double patches_in(double seconds, double seconds_per_pair, double known) {
  return std::sqrt(known * known + std::max(0.0, seconds) / seconds_per_pair);
}

// What the usable memory allows is told, as far as it can be known.
[[noreturn]] void refuse(const Plan& plan, double patches, double reachable) {
  throw MemoryError("accuracy.relative_error=" + percent(*plan.accuracy.relative_error, 2) +
                    "%: found that it takes about " + std::to_string(static_cast<long>(patches)) + " patches and " +
                    gigabytes(memory_needed(static_cast<std::size_t>(patches), plan.assembly, plan.accuracy)) +
                    ", and " + gigabytes(usable_memory(plan.resources)) + " may be taken; expected about " +
                    percent(reachable, 2) + "% or more: ask for that, or for an accuracy.interest");
}

// Once three meshes have told how the error falls with the number of patches: refuses what would take far more than
// fits.
void require_within_reach(const Plan& plan, const std::vector<AccuracyStep>& steps) {
  constexpr double far_more = 2;
  if (steps.size() < 3) return;
  const AccuracyStep& before = steps[steps.size() - 3];
  const AccuracyStep& last = steps.back();
  const double finer = static_cast<double>(last.patches) / before.patches;
  const double order = finer > 1 ? std::log(before.total / last.total) / std::log(finer) : 1;
  const double at_least = std::max(order, mesh_order / 2);
  const double most = patches_that_fit(plan);
  const double needed = last.patches * std::pow(last.total / *plan.accuracy.relative_error, 1 / at_least);
  if (needed > far_more * most) refuse(plan, needed, last.total * std::pow(last.patches / most, at_least));
}

// How many parents can be cut, each into sixteen new patches, before there are so many.
std::size_t cuts_up_to(double patches, const AccuracyStep& step) {
  return static_cast<std::size_t>(std::max(0.0, patches - step.patches) / 16);
}

// What the solver may leave, unless that or its relative error was asked for.
std::optional<double> part_of_solver(const Run& run, double accuracy) {
  const std::optional<double>& asked = run.plan.accuracy.solver_part;
  return asked || run.request.solver.relative_error ? asked : std::optional(share_of_interest * accuracy);
}

// With the samples of the next mesh, and what its solver may leave.
Plan plan_of_next(Plan plan, int samples, const std::optional<double>& solver_part) {
  plan.assembly.samples = samples;
  plan.accuracy.solver_part = solver_part;
  return plan;
}

AccuracyStep accuracy_of(const SolvedMesh& solved) {
  AccuracyStep step = errors_of(solved.simulation, solved.interest);
  step.patches = step.new_patches = solved.simulation.mesh.size();
  return step;
}

}  // namespace

// What the next mesh is made by.
struct Search::Refinement {
  std::vector<std::uint8_t> cut;  // per parent
  int samples = 0;
};

Search::Search(const Run& run) : run_(run), start_(wall_seconds()), cpu_start_(cpu_seconds()) {}

MeshToSolve Search::first() const {
  MeshToSolve first{{}, run_.plan, {}};
  if (run_.with.mesh) {
    first.mesh.patches = run_.with.mesh();
  } else {
    first.mesh = first_mesh(run_.scene, run_.plan);
  }
  if (run_.plan.accuracy.relative_error && !run_.request.solver.relative_error) {
    first.plan.solver.relative_error = share_of_solver * *run_.plan.accuracy.relative_error;
    first.plan.accuracy.solver_part = part_of_solver(run_, *run_.plan.accuracy.relative_error);
  }
  return first;
}

AccuracyStep Search::step_of(const SolvedMesh& solved) const {
  AccuracyStep step = accuracy_of(solved);
  if (!refines(run_.plan.accuracy)) return step;
  step.new_patches -= known_;
  step.seconds = wall_seconds() - start_;
  step.cpu_seconds = cpu_seconds() - cpu_start_;
  return step;
}

SolvedMesh Search::noted(SolvedMesh solved) {
  if (solved.simulation.error_bars) steps_.push_back(step_of(solved));
  solved.simulation.accuracy = steps_;
  if (refines(run_.plan.accuracy) && run_.with.look) run_.with.look(solved.simulation);
  return solved;
}

// The largest number of patches in the time that is left.
double Search::patches_in_time() const {
  if (!run_.plan.accuracy.seconds) return std::numeric_limits<double>::infinity();
  const AccuracyStep& step = steps_.back();
  const double before = steps_.size() > 1 ? steps_[steps_.size() - 2].seconds : 0;
  const double seconds_per_pair = (step.seconds - before) / new_pairs(step);
  return patches_in((*run_.plan.accuracy.seconds - step.seconds) / error_margin, seconds_per_pair, step.patches);
}

// Parents to cut: an eighth at least where the mesh limits, as a mesh that hardly differs costs nearly as much as one
// that does; and those that make the noise, if they are few or nothing else is left. Else more samples.
Search::Refinement Search::refinement(const SolvedMesh& solved, double accuracy) const {
  const AccuracyStep& step = steps_.back();
  const bool by_time = run_.plan.accuracy.seconds.has_value();
  const std::size_t parents = solved.mesh.parents.size();
  const std::size_t most = cuts_up_to(std::min(patches_that_fit(run_.plan), patches_in_time()), step);
  std::vector<std::uint8_t> cut =
      parents_to_cut(solved.effects, {mesh_factor(solved, step, accuracy), mesh_error_left, parents / 8, most});
  const std::vector<std::uint8_t> noisy =
      parents_to_cut(noise_to_cut(solved), {noise_factor(solved, step, accuracy), noise_left, 0, most - count(cut)});
  const bool are_few = static_cast<double>(count(noisy)) <= few * static_cast<double>(parents);
  if (count(noisy) > 0 && (are_few || by_time || step.samples >= most_samples))
    return {either(std::move(cut), noisy), step.samples};
  return {std::move(cut), by_time ? step.samples : samples_for(solved, step, accuracy)};
}

std::optional<MeshToSolve> Search::next(SolvedMesh& solved) {
  if (!refines(run_.plan.accuracy) || !solved.simulation.solution.converged) return std::nullopt;
  const bool by_time = run_.plan.accuracy.seconds.has_value();
  const AccuracyStep& step = steps_.back();
  // Without an accuracy the error is to be halved as long as there is time.
  const double accuracy = run_.plan.accuracy.relative_error.value_or(step.total / 2);
  if (enough * step.total <= accuracy || steps_.size() == most_steps) return std::nullopt;
  // What a tolerance that was asked for leaves no mesh mends.
  if (run_.request.solver.relative_error && step.solver > accuracy) return std::nullopt;
  if (!by_time && step.total > accuracy) require_within_reach(run_.plan, steps_);

  const Refinement by = refinement(solved, accuracy);
  const bool more_samples = by.samples > step.samples;
  const bool finer_mesh = count(by.cut) > 0;
  FinerMesh finer = refine(solved.mesh, by.cut);
  const double most = patches_that_fit(run_.plan);
  const double factor = mesh_factor(solved, step, accuracy);
  if (finer.mesh.patches.size() > most || (!finer_mesh && factor > 1 && cuts_up_to(most, step) == 0)) {
    if (by_time || step.total <= accuracy) return std::nullopt;
    refuse(run_.plan, std::max<double>(finer.mesh.patches.size(), patches_for(step.patches, factor)), step.total);
  }
  if (!more_samples && !finer_mesh) return std::nullopt;
  // The solver's error is never asked to be larger than on the mesh before.
  MeshToSolve to_solve{std::move(finer.mesh),
                       plan_of_next(solved.simulation.plan, by.samples, part_of_solver(run_, accuracy)),
                       {std::move(finer.place), {}, solved.simulation.transport.lost}};
  known_ = 0;
  if (more_samples) return to_solve;
  to_solve.known.exchange = std::move(solved.raw);
  const std::vector<PatchIndex>& place = to_solve.known.place;
  known_ =
      static_cast<PatchIndex>(place.size()) - static_cast<PatchIndex>(std::count(place.begin(), place.end(), no_patch));
  return to_solve;
}

}  // namespace patchlight
