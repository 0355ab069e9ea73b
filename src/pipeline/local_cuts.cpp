#include "pipeline/local_cuts.h"

#include "accuracy/refinement.h"
#include "base/sampling.h"
#include "base/words.h"
#include "plan/choose_storage.h"
#include "plan/goal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

namespace patchlight {
namespace {

// The mesh's share of an error, in quadrature: beside form factors, or rays of rows and to lights, and the solver.
constexpr double share_of_mesh = 0.7;

// The largest that one error may be while the others stay: the rest of the accuracy, but no less than its share.
double allowed(double accuracy, double share, double others) {
  return std::max(share * accuracy, std::sqrt(std::max(0.0, accuracy * accuracy - others * others)));
}

int next_samples(const Plan& plan, double factor) {
  const int samples = samples_of(plan.assembly);
  const double needed = samples * factor * factor;
  int next = samples;
  while (next < needed && next < most_samples(plan)) next = std::min(2 * next, most_samples(plan));
  return std::max(samples, next);
}

// The largest that the error by samples may be while all else stays: mesh, solver, and the rest of the form factors'
// error.
double allowed_noise(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  const double noise = solved.noise_bar;
  const double beside = std::sqrt(std::max(0.0, step.form_factor * step.form_factor - noise * noise));
  return allowed(accuracy, 0.6, std::hypot(step.mesh, step.solver, beside));
}

// The share of an error that the rays of rows, and those to lights, may have, in quadrature.
constexpr double share_to_rays = 0.5;

// at(x) grows with x, between two limits: the least of it that leaves `wanted`, or, where that is not allowed, the most
// of it that is.
auto least_that_leaves(double wanted, double low, double high, const auto& at, const auto& is_allowed) {
  low = std::log(low), high = std::log(high);
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    const auto found = at(std::exp(middle));
    (is_allowed(found) && found.squared_error > wanted ? low : high) = middle;
  }
  auto more = at(std::exp(high));
  return is_allowed(more) ? more : at(std::exp(low));
}

// How often the patches of each parent are cut, the patches that it takes, and the squared error that it leaves.
struct Cuts {
  std::vector<std::uint8_t> of_parent;
  double new_patches = 0;
  double squared_error = 0;
};

// Each until none of its patches has more of the squared error than `most`.
Cuts cuts_down_to(double most, const NestedMesh& mesh, const Eigen::VectorXd& squares) {
  Cuts cuts;
  for (PatchIndex parent = 0; parent < mesh.parents.size(); ++parent) {
    const PatchRange range = mesh.patches_of(parent);
    const double before = range.end - range.begin;
    double patches = before;
    double left = squares[parent];
    int times = 0;
    for (; times < most_local_cuts && left > most * patches; ++times) left *= mesh_error_left, patches *= 4;
    cuts.of_parent.push_back(static_cast<std::uint8_t>(times));
    cuts.new_patches += patches - before;
    cuts.squared_error += left;
  }
  return cuts;
}

// The fewest that leave `wanted`, with so many new patches at most.
Cuts best_cuts(const NestedMesh& mesh, const Eigen::VectorXd& squares, double wanted, double most) {
  const double all = squares.sum();
  const auto cuts_at = [&](double x) { return cuts_down_to(1 / x, mesh, squares); };
  if (!(all > 0)) return {std::vector<std::uint8_t>(mesh.parents.size(), 0), 0, 0};
  return least_that_leaves(wanted, 1 / all, 1e15 / all, cuts_at,
                           [&](const Cuts& cuts) { return cuts.new_patches <= most; });
}

// Noise of the patches of a mesh.
struct Noise {
  std::vector<double> squares;        // its part in the squared error
  std::vector<double> rays;           // that make it, to a factor
  std::vector<std::uint8_t> doubled;  // how often these are doubled already
};

// How often the rays of each patch are doubled, which ones more often than before, how many more rays that are, as a
// share of all, and the squared error that it leaves.
struct Doublings {
  std::vector<std::uint8_t> of_patch;
  std::vector<std::uint8_t> is_doubled;
  double more_rays = 0;
  double squared_error = 0;
  bool any = false;
};

// Each until another doubling of as many rays as then would gain less than `least`, or would be more than `most`.
Doublings doublings_down_to(double least, int most, const Noise& noise) {
  Doublings doublings;
  double all = 0;
  for (std::size_t i = 0; i < noise.rays.size(); ++i) {
    double square = noise.squares[i];
    double rays = noise.rays[i];
    const int left = std::min(4, most - noise.doubled[i]);
    int times = 0;
    for (; times < left && square > least * rays; ++times) square /= 2, rays *= 2;
    doublings.of_patch.push_back(static_cast<std::uint8_t>(noise.doubled[i] + times));
    doublings.is_doubled.push_back(times > 0 ? 1 : 0);
    doublings.squared_error += square;
    doublings.more_rays += rays - noise.rays[i];
    doublings.any = doublings.any || times > 0;
    all += noise.rays[i];
  }
  doublings.more_rays /= all;
  return doublings;
}

// How often the rays of each patch of a finer mesh are doubled, as those in its place are.
std::vector<std::uint8_t> doubled_on(const FinerMesh& finer, const NestedMesh& before,
                                     const std::vector<std::uint8_t>& doublings) {
  std::vector<std::uint8_t> doubled(finer.place.size(), 0);
  if (doublings.empty()) return doubled;
  for (std::size_t i = 0; i < doubled.size(); ++i) {
    const auto [begin, end] = before.patches_of(finer.parent_before[i]);
    doubled[i] = finer.place[i] != no_patch ? doublings[finer.place[i]]
                                            : *std::max_element(doublings.begin() + begin, doublings.begin() + end);
  }
  return doubled;
}

// On a finer mesh. A smaller patch has fewer rays, by the root of its area.
Noise noise_on(const FinerMesh& finer, const NestedMesh& before, const Eigen::VectorXd& squares,
               const std::vector<std::uint8_t>& doublings, const Goal* goal) {
  const PatchMesh& mesh = finer.mesh.patches;
  const std::vector<double> areas = important_areas(mesh, goal);
  const double usual_area = mean_area(areas);
  const Eigen::VectorXd of_parents = summed_by_parent(before, squares.array()).col(0).matrix();
  Noise noise{{}, {}, doubled_on(finer, before, doublings)};
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const PatchIndex parent = finer.parent_before[i];
    const PatchRange range = before.patches_of(parent);
    const double share = mesh.area[i] / before.parents.area[parent];
    noise.squares.push_back(finer.place[i] != no_patch
                                ? squares[finer.place[i]]
                                : of_parents[parent] * std::sqrt(share / (range.end - range.begin)));
    noise.rays.push_back(std::ldexp(std::clamp(std::sqrt(areas[i] / usual_area), 0.25, 4.0), noise.doubled[i]));
  }
  return noise;
}

// The error by rays, the square of it that may be left, by how much they may grow, and how often they may be doubled.
struct NoiseGoal {
  double error = 0;
  double wanted = 0;
  double more_rays = 0;
  int most_doublings = 0;
};

// The fewest for which the error falls to what may be left, within the limits; none where there is no error.
Doublings best_doublings(Noise noise, const NoiseGoal& goal) {
  const double sum = std::accumulate(noise.squares.begin(), noise.squares.end(), 0.0);
  const double error = goal.error * goal.error;
  for (double& square : noise.squares) square = sum > 0 ? error / sum * square : 0;
  const auto doublings_at = [&](double x) { return doublings_down_to(1 / x, goal.most_doublings, noise); };
  return least_that_leaves(goal.wanted, 1e-6 / goal.wanted, 1e15 / goal.wanted, doublings_at,
                           [&](const Doublings& doublings) { return doublings.more_rays <= goal.more_rays; });
}

// Parents' parts in the squared error by the mesh that cuts reduce.
Eigen::VectorXd squares_of(const SolvedMesh& solved, double error, bool of_lamps) {
  const double sum = solved.effects.cwiseMax(0).sum();
  if (!(sum > 0)) return Eigen::VectorXd::Zero(solved.effects.size());
  Eigen::VectorXd squares = error * error / sum * solved.effects.cwiseMax(0);
  if (of_lamps) return squares;
  const Field& exitance = solved.simulation.problem.exitance;
  for (PatchIndex i = 0; i < solved.mesh.patches.size(); ++i)
    if ((exitance.row(i) > 0).any()) squares[solved.mesh.parent[i]] = 0;
  return squares;
}

// How often rays may be doubled before they are more than are worth their time.
int doublings_worth_it(const Plan& plan) {
  return std::bit_width(static_cast<unsigned>(most_samples(plan) / plan.assembly.rays)) - 1;
}

// The square of allowed(), from the sum of the squares of the others.
double allowed_square(double error, double share, double others) {
  return std::pow(allowed(error, share, std::sqrt(others)), 2);
}

// No second mesh reduces a smaller error.
constexpr double usual_error = 0.02;

// The goal of a second mesh. Rays of rows cost less than those to sun and sky, which are more.
constexpr LocalGoal goal_of_second_mesh{
    .error = usual_error / error_margin, .new_patches = 0.25, .more_to_lights = 0.5, .more_of_rows = 1.5};

std::string errors_of_first(const AccuracyStep& errors) {
  return "the first mesh, of " + std::to_string(errors.patches) + " patches, has an error of " +
         percent(errors.total, 2) + " %: ";
}

Diagnostics notes_on_cuts(const MeshToSolve& next, const AccuracyStep& errors) {
  const auto is_doubled = [&](std::size_t i) {
    const auto any = [i](const std::vector<std::uint8_t>& doublings) { return !doublings.empty() && doublings[i] > 0; };
    return any(next.known.more_rays.to_lights) || any(next.known.more_rays.of_rows);
  };
  const std::size_t cut = errors.patches - number_kept(next.known.place);
  std::size_t doubled = 0;
  for (std::size_t i = 0; i < next.known.place.size(); ++i) doubled += is_doubled(i) ? 1 : 0;
  const std::string cuts = cut > 0 ? std::to_string(cut) + " of them are cut" : "";
  const std::string rays = doubled > 0 ? std::to_string(doubled) + " patches get more rays" : "";
  return {{DiagnosticCode::second_mesh, errors_of_first(errors) + "in a second one " + cuts +
                                            (cuts.empty() || rays.empty() ? "" : ", and ") + rays +
                                            "; accuracy.local_cuts=false keeps the first"}};
}

Diagnostics notes_on_memory(const LocalCuts& cuts, const AccuracyStep& errors, const Plan& plan) {
  const std::size_t patches = cuts.mesh.mesh.patches.size();
  const double bytes = memory_of_next_mesh(patches, times_the_rays(cuts), plan);
  return {{DiagnosticCode::second_mesh, errors_of_first(errors) + "a second one, of " + std::to_string(patches) +
                                            " patches, would have a smaller error and is not made: it " +
                                            memory_refused(bytes, plan.resources)}};
}

}  // namespace

int most_samples(const Plan& plan) { return plan.assembly.storage == Storage::rays ? 4096 : 256; }

double patches_for(double patches, double factor) { return patches * std::pow(std::max(1.0, factor), 2 / mesh_order); }

double mesh_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  const double lights = solved.light_bar;
  const double beside = std::sqrt(std::max(0.0, step.form_factor * step.form_factor - lights * lights));
  return error_margin * std::hypot(step.mesh, lights) /
         allowed(accuracy, share_of_mesh, std::hypot(beside, step.solver));
}

double noise_factor(const SolvedMesh& solved, const AccuracyStep& step, double accuracy) {
  return error_margin * solved.noise_bar / allowed_noise(solved, step, accuracy);
}

int samples_for(const SolvedMesh& solved, const AccuracyStep& step, double accuracy, const Plan& plan) {
  const int samples = samples_of(plan.assembly);
  if (plan.assembly.storage != solved.simulation.plan.assembly.storage) return samples;
  if (mesh_factor(solved, step, accuracy) > 1.5) return samples;
  const double patches = patches_for(step.patches, mesh_factor(solved, step, accuracy));
  const double factor = noise_factor(solved, step, accuracy) * std::sqrt(step.patches / patches);
  return factor > error_margin ? next_samples(plan, factor) : samples;
}

LocalCuts local_cuts(const SolvedMesh& solved, const AccuracyStep& errors, const LocalGoal& goal) {
  const double by_lights = solved.light_bar * solved.light_bar;
  const double by_rows = solved.noise_bar * solved.noise_bar;

  // 1. Patches by the errors of their size.
  const Eigen::VectorXd squares = squares_of(solved, std::sqrt(solved.share_cuts_mend) * errors.mesh, goal.cuts_lamps);
  const Cuts cuts = best_cuts(solved.mesh, squares, allowed_square(goal.error, share_of_mesh, by_lights + by_rows),
                              goal.new_patches * solved.mesh.patches.size());
  FinerMesh finer = cut_patches(solved.mesh, cuts.of_parent);

  // 2. Rays by theirs.
  const int most = doublings_worth_it(solved.simulation.plan);
  const auto doublings = [&](const Eigen::VectorXd& noise, const std::vector<std::uint8_t>& before,
                             const NoiseGoal& noise_goal) {
    if (noise.size() == 0) return Doublings{};
    return best_doublings(noise_on(finer, solved.mesh, noise, before, solved.simulation.plan.goal.get()), noise_goal);
  };
  const double lights_may = allowed_square(goal.error, share_to_rays, cuts.squared_error + by_rows);
  Doublings to_lights = doublings(solved.light_noise, solved.more_rays.to_lights,
                                  {solved.light_bar, lights_may, goal.more_to_lights, most});
  const double rows_may = allowed_square(goal.error, share_to_rays, cuts.squared_error + to_lights.squared_error);
  Doublings of_rows =
      doublings(solved.row_noise, solved.more_rays.of_rows, {solved.noise_bar, rows_may, goal.more_of_rows, most});

  // 3. Its cost and gain.
  LocalCuts found{std::move(finer), {}, {}, 0, cuts.new_patches > 0 || to_lights.any || of_rows.any};
  found.gain =
      squares.sum() - cuts.squared_error + by_lights - to_lights.squared_error + by_rows - of_rows.squared_error;
  found.light_place = found.mesh.place;
  for (std::size_t i = 0; i < to_lights.is_doubled.size(); ++i)
    if (to_lights.is_doubled[i] != 0) found.light_place[i] = no_patch;
  found.more_rays = {std::move(to_lights.of_patch), std::move(of_rows.of_patch)};
  return found;
}

double times_the_rays(const LocalCuts& cuts) {
  return multiples(cuts.more_rays.of_rows, static_cast<Eigen::Index>(cuts.light_place.size())).mean();
}

MeshToSolve mesh_with(LocalCuts cuts, SolvedMesh& solved) {
  MeshToSolve next{std::move(cuts.mesh.mesh), solved.simulation.plan, {}};
  next.plan.solver.keeps_unfinished = false;
  next.known.place = std::move(cuts.mesh.place);
  next.known.light = std::move(solved.light);
  next.known.light_place = std::move(cuts.light_place);
  next.known.more_rays = std::move(cuts.more_rays);
  return next;
}

bool makes_second_mesh(const Plan& plan, PatchIndex patches) {
  const AccuracyOptions& accuracy = plan.accuracy;
  return accuracy.local_cuts && accuracy.error_bars && !refines(accuracy) && plan.assembly.storage == Storage::rays &&
         patches <= 100'000;  // with more a second mesh takes minutes
}

bool makes_second_mesh(const Run& run, PatchIndex patches) {
  return makes_second_mesh(run.plan, patches) && !run.with.mesh && !run.with.ray_exchange && !run.with.solve;
}

bool cuts_locally(const Run& run, PatchIndex patches) {
  return refines(run.plan.accuracy) || makes_second_mesh(run, patches);
}

SecondMesh second_mesh(const Run& run, SolvedMesh& solved, const AccuracyStep& errors) {
  if (!makes_second_mesh(run, errors.patches) || !(errors.total > usual_error)) return {};
  LocalCuts cuts = local_cuts(solved, errors, goal_of_second_mesh);
  // It pays where it leaves less than 0.7 of the error.
  if (!(cuts.gain > (1 - 0.7 * 0.7) * errors.total * errors.total)) return {};
  const Plan& plan = solved.simulation.plan;
  if (!fits_as_next_mesh(cuts.mesh.mesh.patches.size(), times_the_rays(cuts), plan))
    return {std::nullopt, notes_on_memory(cuts, errors, plan)};
  MeshToSolve mesh = mesh_with(std::move(cuts), solved);
  Diagnostics notes = notes_on_cuts(mesh, errors);
  return {std::move(mesh), std::move(notes)};
}

Plan with_note_on_second_mesh(Plan plan, PatchIndex patches) {
  if (!makes_second_mesh(plan, patches) || fits_as_next_mesh(patches, 1, plan)) return plan;
  plan.notes.push_back({DiagnosticCode::second_mesh,
                        "a second mesh, which is made where the first has an error of more than " +
                            percent(usual_error) + " %, does not fit into the memory beside the first: it " +
                            memory_refused(memory_of_next_mesh(patches, 1, plan), plan.resources)});
  return plan;
}

}  // namespace patchlight
