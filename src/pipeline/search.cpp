#include "pipeline/search.h"

#include "patchlight/base/error.h"

#include "accuracy/errors.h"
#include "accuracy/refinement.h"
#include "base/parallel.h"
#include "base/sampling.h"
#include "base/words.h"
#include "mesh/nested_mesh.h"
#include "pipeline/first_mesh.h"
#include "pipeline/local_cuts.h"
#include "pipeline/radiosity_errors.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>

namespace patchlight {
namespace {

// The patches that an accuracy takes.
struct Needed {
  double patches = 0;
  double reachable = 0;  // the error with as many patches as fit
};

// Where far more patches are needed for the accuracy than fit, by the decrease of the error over three meshes. Never by
// rows of rays, whose rays have errors as well.
std::optional<Needed> out_of_reach(const Plan& plan, std::span<const AccuracyStep> steps) {
  if (steps.size() < 3 || plan.assembly.storage == Storage::rays) return std::nullopt;
  const AccuracyStep& before = steps[steps.size() - 3];
  const AccuracyStep& last = steps.back();
  const double finer = static_cast<double>(last.patches) / before.patches;
  const double order = finer > 1 ? std::log(before.total / last.total) / std::log(finer) : 1;
  const double at_least = std::max(order, mesh_order / 2);
  const double most = patches_that_fit(plan);
  const double needed = last.patches * std::pow(last.total / *plan.accuracy.relative_error, 1 / at_least);
  if (needed <= 2 * most) return std::nullopt;
  return Needed{needed, last.total * std::pow(last.patches / most, at_least)};
}

// Throws MemoryError with the memory that the patches need, and the reachable error.
[[noreturn]] void refuse(const Plan& plan, const Needed& needed) {
  const auto& [patches, reachable] = needed;
  throw MemoryError("accuracy.relative_error=" + percent(*plan.accuracy.relative_error, 2) + "% needs about " +
                    std::to_string(static_cast<long>(patches)) + " patches and " +
                    gigabytes(memory_needed(static_cast<std::size_t>(patches), plan)) + ", and " +
                    gigabytes(usable_memory(plan.resources)) + " is allowed\nhint: accuracy.relative_error=" +
                    percent(reachable, 2) + "% or more\nhint: or improve a part only: accuracy.interest");
}

// The plan of a mesh with this mean number of rays per patch, for estimating its memory.
Plan with_rays_of(const LocalCuts& cuts, Plan plan) {
  plan.assembly.rays = static_cast<int>(std::ceil(times_the_rays(cuts) * plan.assembly.rays));
  return plan;
}

// Cuts that leave a relative error, by the errors of the mesh before, which allow a limited growth at once, and no more
// than time and memory do: the last mesh could be solved so many `times` in the time that is left.
std::optional<LocalCuts> cuts_that_fit(const SolvedMesh& solved, const AccuracyStep& step, double error, double times) {
  // Both patches and rays raise the cost. The errors of one mesh are trusted for at most four times the patches and
  // three times the rays; growth below 10 % does not pay for another mesh.
  double growth = std::min(3.0, std::sqrt(std::max(0.0, times)) - 1);
  for (; growth > 0.1; growth /= 2) {
    const double more_rays = std::min(2.0, growth);
    LocalCuts cuts = local_cuts(solved, step, {error / error_margin, growth, more_rays, more_rays, true});
    const Plan plan = with_rays_of(cuts, solved.simulation.plan);
    if (!cuts.changes || memory_needed(cuts.light_place.size(), plan) <= usable_memory(plan.resources)) return cuts;
  }
  return std::nullopt;
}

// The mesh after one by rows of rays, by local_cuts(); takes the known light of other patches from `solved`. `steps`
// has the errors of all meshes until now. None where nothing more is gained, or fits into the time. Throws MemoryError
// where there is time and the memory does not suffice.
std::optional<MeshToSolve> next_mesh_by_rays(SolvedMesh& solved, std::span<const AccuracyStep> steps, double error,
                                             double times) {
  const AccuracyStep& step = steps.back();
  // More rays no longer reduce the error.
  if (step.new_patches == 0 && step.total > 0.95 * steps[steps.size() - 2].total) return std::nullopt;
  std::optional<LocalCuts> cuts = cuts_that_fit(solved, step, error, times);
  if (!cuts) {
    const Plan& plan = solved.simulation.plan;
    if (plan.accuracy.seconds) return std::nullopt;
    constexpr double any = std::numeric_limits<double>::infinity();
    const LocalCuts wanted = local_cuts(solved, step, {error / error_margin, any, any, any, true});
    refuse(with_rays_of(wanted, plan), {static_cast<double>(wanted.light_place.size()), step.total});
  }
  if (!cuts->changes) return std::nullopt;
  return mesh_with(std::move(*cuts), solved);
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

// The number of patches of a mesh that needs `times` as many new pairs as the last one did.
double patches_with(double times, const AccuracyStep& step) {
  return std::sqrt(static_cast<double>(step.patches) * step.patches + std::max(0.0, times) * new_pairs(step));
}

// The number of parents that can be cut, each into sixteen new patches, up to `patches` patches.
std::size_t cuts_up_to(double patches, const AccuracyStep& step) {
  return static_cast<std::size_t>(std::max(0.0, patches - step.patches) / 16);
}

// AccuracyOptions::solver_part: a tenth of the accuracy, unless the request sets it or the solver's relative error.
std::optional<double> part_of_solver(const Run& run, double accuracy) {
  const std::optional<double>& asked = run.plan.accuracy.solver_part;
  return asked || run.request.solver.relative_error ? asked : std::optional(0.1 * accuracy);
}

Plan with_samples(Plan plan, int samples) {
  (plan.assembly.storage == Storage::rays ? plan.assembly.rays : plan.assembly.samples) = samples;
  return plan;
}

AccuracyStep accuracy_of(const SolvedMesh& solved) {
  AccuracyStep step = errors_of(solved.simulation, solved.interest);
  step.patches = step.new_patches = solved.simulation.mesh.size();
  step.inside = solved.simulation.plan.accuracy.interest.empty() && (solved.interest.array() == 0).any();
  return step;
}

}  // namespace

// The cuts and samples of the next mesh.
struct Search::Refinement {
  std::vector<std::uint8_t> cut;  // per parent
  int samples = 0;
};

// The next mesh and its plan.
struct Search::Finer {
  FinerMesh mesh;
  Plan plan;
  bool has_more_patches = false;
  bool fits = false;
};

Search::Search(const Run& run) : run_(run), start_(wall_seconds()), cpu_start_(cpu_seconds()) {}

MeshToSolve Search::first() const {
  MeshToSolve first{{}, run_.plan, {}};
  if (run_.with.mesh) {
    first.mesh.patches = run_.with.mesh();
  } else {
    first.mesh = first_mesh(run_.scene, run_.plan, run_.world->between_patches());
  }
  first.plan.solver.keeps_unfinished = static_cast<bool>(run_.with.keeps_unfinished);
  if (run_.plan.accuracy.relative_error && !run_.request.solver.relative_error) {
    // A bound for all patches together; single patches may have five times as much.
    first.plan.solver.relative_error = 0.02 * *run_.plan.accuracy.relative_error;
    first.plan.accuracy.solver_part = part_of_solver(run_, *run_.plan.accuracy.relative_error);
  }
  return first;
}

AccuracyStep Search::step_of(const SolvedMesh& solved) const {
  AccuracyStep step = accuracy_of(solved);
  step.new_patches -= known_;
  const double multiple = multiples(solved.more_rays.of_rows, solved.simulation.mesh.size()).mean();
  step.samples = static_cast<int>(std::lround(step.samples * multiple));
  step.seconds = wall_seconds() - start_;
  step.cpu_seconds = cpu_seconds() - cpu_start_;
  return step;
}

void Search::keep(const Simulation& simulation) {
  if (!run_.with.keeps_unfinished || (kept_ && !simulation.error_bars)) return;
  if (!may_keep_solution(simulation.mesh.size(), simulation.plan)) return;
  // With known rows nothing follows that could be stopped.
  if (run_.with.ray_exchange) return run_.with.keeps_unfinished();
  kept_ = simulation;
  kept_->unfinished = true;
  run_.with.keeps_unfinished();
}

SolvedMesh Search::noted(SolvedMesh solved) {
  solved.more_rays = more_rays_;
  if (solved.simulation.error_bars) steps_.push_back(step_of(solved));
  solved.simulation.notes = merged({std::move(solved.simulation.notes), notes_});
  solved.simulation.accuracy = steps_;
  const bool may_be_followed =
      refines(run_.plan.accuracy) || (!steps_.empty() && makes_second_mesh(run_, steps_[0].patches));
  if (!may_be_followed) return solved;
  keep(solved.simulation);
  if (run_.with.look) run_.with.look(solved.simulation);
  return solved;
}

// How many times the last mesh could be solved again in the time that is left.
double Search::times_in_time() const {
  if (!run_.plan.accuracy.seconds) return std::numeric_limits<double>::infinity();
  const double now = steps_.back().seconds;
  const double before = steps_.size() > 1 ? steps_[steps_.size() - 2].seconds : 0;
  return (*run_.plan.accuracy.seconds - now) / error_margin / (now - before);
}

// Parents to cut: an eighth at least where the mesh limits, as a mesh that hardly differs costs nearly as much as one
// that does; and those that make the noise, e.g. lamps, if they are at most a quarter or nothing else is left: that
// samples them more, and all other pairs stay known. Else more samples.
Search::Refinement Search::refinement(const SolvedMesh& solved, double accuracy, const Plan& plan) const {
  const AccuracyStep& step = steps_.back();
  const int samples = samples_of(plan.assembly);
  const bool by_time = run_.plan.accuracy.seconds.has_value();
  const int more = by_time ? samples : samples_for(solved, step, accuracy, plan);
  const std::size_t parents = solved.mesh.parents.size();
  const double fitting = patches_that_fit(with_samples(plan, more));
  const std::size_t most = cuts_up_to(std::min(fitting, patches_with(times_in_time(), step)), step);
  std::vector<std::uint8_t> cut =
      parents_to_cut(solved.effects, {mesh_factor(solved, step, accuracy), mesh_error_left, parents / 8, most});
  const std::vector<std::uint8_t> noisy =
      parents_to_cut(solved.noise, {noise_factor(solved, step, accuracy), noise_left, 0, most - count(cut)});
  const bool are_few = static_cast<double>(count(noisy)) <= 0.25 * static_cast<double>(parents);
  if (count(noisy) == 0 || !(are_few || by_time || step.samples >= most_samples(plan))) return {std::move(cut), more};
  for (std::size_t k = 0; k < cut.size(); ++k) cut[k] |= noisy[k];
  return {std::move(cut), samples};
}

bool Search::may_go_by_rays(const Plan& plan) const {
  return !run_.plan.accuracy.seconds && run_.request.assembly.storage == Storage::automatic &&
         plan.assembly.storage == Storage::tiles && !part_that_takes_pairs(run_.request, given_by(run_.with));
}

Plan Search::gone_by_rays(const Plan& plan) {
  notes_.push_back({DiagnosticCode::rows_of_rays,
                    "form factors of more than " + std::to_string(steps_.back().patches) +
                        " patches are rows of rays (assembly.storage=rays), because all pairs of the patches that the "
                        "accuracy needs do not fit into the memory"});
  return by_rays(plan);
}

// If the accuracy is out of reach with pairs, the next mesh uses rays, unless the request requires pairs.
Plan Search::stored_for(const SolvedMesh& solved, double accuracy) {
  const Plan& plan = solved.simulation.plan;
  if (run_.plan.accuracy.seconds || steps_.back().total <= accuracy) return plan;
  const std::optional<Needed> needed = out_of_reach(plan, steps_);
  if (!needed) return plan;
  if (may_go_by_rays(plan)) return gone_by_rays(plan);
  refuse(plan, *needed);
}

Search::Finer Search::finer(const SolvedMesh& solved, double accuracy, const Plan& plan) const {
  const Refinement by = refinement(solved, accuracy, plan);
  Finer next{refine(solved.mesh, by.cut), with_samples(plan, by.samples), count(by.cut) > 0};
  const AccuracyStep& step = steps_.back();
  const double most = patches_that_fit(next.plan);
  const bool nothing_more_fits = cuts_up_to(most, step) == 0;
  const bool needs_more = mesh_factor(solved, step, accuracy) > 1;
  next.fits = next.mesh.mesh.patches.size() <= most && (next.has_more_patches || !needs_more || !nothing_more_fits);
  return next;
}

MeshToSolve Search::remembered(MeshToSolve next, bool keeps_known) {
  known_ = keeps_known ? number_kept(next.known.place) : 0;
  more_rays_ = next.known.more_rays;
  next.known.meshes = steps_.size();
  return next;
}

std::optional<MeshToSolve> Search::next_by_rays(SolvedMesh& solved, double accuracy) {
  std::optional<MeshToSolve> next = next_mesh_by_rays(solved, steps_, accuracy, times_in_time());
  if (!next) return next;
  next->plan.accuracy.solver_part = part_of_solver(run_, accuracy);
  return remembered(std::move(*next), true);
}

std::optional<MeshToSolve> Search::second(SolvedMesh& solved) {
  if (steps_.size() > 1) return std::nullopt;
  SecondMesh next = second_mesh(run_, solved, steps_.back());
  Diagnostics& notes = next.mesh ? notes_ : solved.simulation.notes;
  notes = merged({std::move(notes), std::move(next.notes)});
  if (!next.mesh) return std::nullopt;
  return remembered(std::move(*next.mesh), true);
}

std::optional<MeshToSolve> Search::next(SolvedMesh& solved) {
  if (!solved.simulation.solution.converged || steps_.empty()) return std::nullopt;
  if (!refines(run_.plan.accuracy)) return second(solved);
  const AccuracyStep& step = steps_.back();
  // Without an accuracy, the goal is half of the error, as long as there is time.
  const double accuracy = run_.plan.accuracy.relative_error.value_or(step.total / 2);
  const bool is_by_rays = solved.simulation.plan.assembly.storage == Storage::rays;
  // Pairs stop 10 % below the accuracy, because errors are estimates. A mesh by rays aims at a lower error than that,
  // and another mesh would cost as much again.
  if ((is_by_rays ? 1 : 1.1) * step.total <= accuracy || steps_.size() == 20) return std::nullopt;
  // No mesh reduces the error that a given tolerance leaves.
  if (run_.request.solver.relative_error && step.solver > accuracy) return std::nullopt;
  if (!std::isfinite(step.solver)) return std::nullopt;
  return is_by_rays ? next_by_rays(solved, accuracy) : next_by_pairs(solved, accuracy);
}

std::optional<MeshToSolve> Search::next_by_pairs(SolvedMesh& solved, double accuracy) {
  const AccuracyStep& step = steps_.back();

  // 1. More patches and samples, by rays where all pairs of them do not fit.
  Plan plan = stored_for(solved, accuracy);
  Finer more = finer(solved, accuracy, plan);
  if (!more.fits && step.total > accuracy && may_go_by_rays(plan)) more = finer(solved, accuracy, gone_by_rays(plan));
  if (!more.fits) {
    if (run_.plan.accuracy.seconds || step.total <= accuracy) return std::nullopt;
    const double patches = patches_for(step.patches, mesh_factor(solved, step, accuracy));
    refuse(more.plan, {std::max<double>(more.mesh.mesh.patches.size(), patches), step.total});
  }
  const AssemblyOptions& before = solved.simulation.plan.assembly;
  const AssemblyOptions& after = more.plan.assembly;
  const bool all_new = after.storage != before.storage || samples_of(after) != samples_of(before);
  if (!all_new && !more.has_more_patches) return std::nullopt;

  // 2. Known quantities. The solver's relative error never increases from one mesh to the next.
  const bool keeps_known = !all_new && keeps_entries(after.storage);
  MeshToSolve to_solve{std::move(more.mesh.mesh), more.plan, {}};
  to_solve.plan.accuracy.solver_part = part_of_solver(run_, accuracy);
  to_solve.plan.solver.keeps_unfinished = false;
  to_solve.known.place = std::move(more.mesh.place);
  to_solve.known.lost = solved.simulation.transport.lost;
  if (keeps_known) to_solve.known.exchange = std::move(solved.raw);
  return remembered(std::move(to_solve), keeps_known);
}

}  // namespace patchlight
