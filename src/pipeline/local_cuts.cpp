#include "pipeline/local_cuts.h"

#include "accuracy/errors.h"
#include "accuracy/refinement.h"
#include "base/rounded.h"
#include "mesh/nested_mesh.h"
#include "mesh/small_patches.h"
#include "plan/memory.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// An error of so much of the reflected light is left as it is where none was asked for.
constexpr double usual_error = 0.02;
// Shares of it that the mesh, the rays of rows and those to lights may err, in quadrature.
constexpr double share_to_mesh = 0.7;
constexpr double share_to_rays = 0.5;
// It pays where it leaves less than this share of the error.
constexpr double worthwhile = 0.7;

// With more patches a second mesh takes minutes: who wants it asks for an accuracy.
constexpr PatchIndex most_patches = 100'000;

// So many new patches at most, as a share of all.
constexpr double most_new_patches = 0.25;
// So many more rays at most, as a share of all, and how often those of a patch are doubled. Rays of rows cost less than
// those to sun and sky, which are more.
constexpr double most_more_to_lights = 0.5;
constexpr double most_more_of_rows = 1.5;
constexpr int most_doublings = 4;

// The largest x between two for which is_allowed(x) holds, where it holds for all below one number and for none above;
// the lowest where it never does.
double largest_with(double low, double high, const auto& is_allowed) {
  low = std::log(low), high = std::log(high);
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    (is_allowed(std::exp(middle)) ? low : high) = middle;
  }
  return std::exp(low);
}

// How often the patches of each parent are cut, what that takes, and what it leaves.
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

// The fewest that leave what may be left, within the limits.
Cuts best_cuts(const NestedMesh& mesh, const Eigen::VectorXd& squares) {
  const double wanted = std::pow(share_to_mesh * usual_error, 2);
  const double most = most_new_patches * mesh.patches.size();
  const double all = squares.sum();
  const auto cuts_at = [&](double x) { return cuts_down_to(1 / x, mesh, squares); };
  if (!(all > 0)) return {std::vector<std::uint8_t>(mesh.parents.size(), 0), 0, 0};
  const double found = largest_with(1 / all, 1e15 / all, [&](double x) {
    const Cuts cuts = cuts_at(x);
    return cuts.new_patches <= most && cuts.squared_error >= wanted;
  });
  return cuts_at(found);
}

// How often the rays of each patch are doubled, how many more that are, as a share of all, and what it leaves.
struct Doublings {
  std::vector<std::uint8_t> of_patch;
  double more_rays = 0;
  double squared_error = 0;
};

// Noise of the patches of a mesh with as many rays as are usual.
struct Noise {
  std::vector<double> squares;  // its part in the squared error
  std::vector<double> rays;     // to a factor
};

// Each until another doubling of as many rays as then would gain less than `least`.
Doublings doublings_down_to(double least, const Noise& noise) {
  Doublings doublings;
  double all = 0;
  for (std::size_t i = 0; i < noise.rays.size(); ++i) {
    double square = noise.squares[i];
    double rays = noise.rays[i];
    int times = 0;
    for (; times < most_doublings && square > least * rays; ++times) square /= 2, rays *= 2;
    doublings.of_patch.push_back(static_cast<std::uint8_t>(times));
    doublings.squared_error += square;
    doublings.more_rays += rays - noise.rays[i];
    all += noise.rays[i];
  }
  doublings.more_rays /= all;
  return doublings;
}

// On a finer mesh. A smaller patch has fewer rays, by the root of its area.
Noise noise_on(const FinerMesh& finer, const NestedMesh& before, const Eigen::VectorXd& squares) {
  const PatchMesh& mesh = finer.mesh.patches;
  const double usual_area = mean_area(mesh);
  const Eigen::VectorXd of_parents = summed_by_parent(before, squares.array()).col(0).matrix();
  Noise noise;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const PatchIndex parent = finer.parent_before[i];
    const PatchRange range = before.patches_of(parent);
    const double share = mesh.area[i] / before.parents.area[parent];
    noise.squares.push_back(finer.place[i] != no_patch
                                ? squares[finer.place[i]]
                                : of_parents[parent] * std::sqrt(share / (range.end - range.begin)));
    noise.rays.push_back(std::clamp(std::sqrt(mesh.area[i] / usual_area), 0.25, 4.0));
  }
  return noise;
}

// The fewest for which the error, of which `squares` have the parts of the patches before, falls to its share, with
// `most` more rays; none where there is no error.
Doublings doublings_for(const FinerMesh& finer, const NestedMesh& before, const Eigen::VectorXd& squares, double error,
                        double most) {
  const double sum = squares.sum();
  if (!(error > 0 && sum > 0)) return {{}, 0, error * error};
  const double wanted = std::pow(share_to_rays * usual_error, 2);
  const Noise noise = noise_on(finer, before, error * error / sum * squares);
  const double found = largest_with(1e-6 / wanted, 1e15 / wanted, [&](double x) {
    const Doublings doublings = doublings_down_to(1 / x, noise);
    return doublings.more_rays <= most && doublings.squared_error >= wanted;
  });
  return doublings_down_to(1 / found, noise);
}

// Parents' parts in the squared error by the mesh that cuts mend; none of lamps, which are not cut for what they err.
Eigen::VectorXd squares_of(const SolvedMesh& solved, double error) {
  const double sum = solved.effects.cwiseMax(0).sum();
  if (!(sum > 0)) return Eigen::VectorXd::Zero(solved.effects.size());
  Eigen::VectorXd squares = error * error / sum * solved.effects.cwiseMax(0);
  const Field& exitance = solved.simulation.problem.exitance;
  for (PatchIndex i = 0; i < solved.mesh.patches.size(); ++i)
    if ((exitance.row(i) > 0).any()) squares[solved.mesh.parent[i]] = 0;
  return squares;
}

}  // namespace

bool cuts_locally(const Plan& plan, PatchIndex patches) {
  const AccuracyOptions& accuracy = plan.accuracy;
  return accuracy.local_cuts && accuracy.error_bars && !refines(accuracy) && plan.assembly.storage == Storage::rays &&
         patches <= most_patches;
}

bool cuts_locally(const Run& run, PatchIndex patches) {
  return cuts_locally(run.plan, patches) && !run.with.mesh && !run.with.ray_exchange && !run.with.solve;
}

std::optional<MeshToSolve> with_local_cuts(const Run& run, SolvedMesh& solved, const AccuracyStep& errors) {
  if (!cuts_locally(run, errors.patches) || !(errors.total > usual_error)) return std::nullopt;

  // 1. Patches where their size errs.
  const Eigen::VectorXd squares = squares_of(solved, std::sqrt(solved.share_cuts_mend) * errors.mesh);
  const Cuts cuts = best_cuts(solved.mesh, squares);
  FinerMesh finer = cut_patches(solved.mesh, cuts.of_parent);

  // 2. Rays where they do.
  Doublings to_lights = doublings_for(finer, solved.mesh, solved.light_noise, solved.light_bar, most_more_to_lights);
  Doublings of_rows = doublings_for(finer, solved.mesh, solved.row_noise, solved.noise_bar, most_more_of_rows);

  // 3. Where that pays, and fits.
  const double gained = squares.sum() - cuts.squared_error + std::pow(solved.light_bar, 2) - to_lights.squared_error +
                        std::pow(solved.noise_bar, 2) - of_rows.squared_error;
  const bool pays = gained > (1 - worthwhile * worthwhile) * errors.total * errors.total;
  if (!pays || !fits_as_next_mesh(finer.mesh.patches.size(), 1 + of_rows.more_rays, solved.simulation.plan))
    return std::nullopt;
  MeshToSolve next{std::move(finer.mesh), solved.simulation.plan, {}};
  next.plan.solver.keeps_unfinished = false;
  next.known.place = std::move(finer.place);
  next.known.light = std::move(solved.light);
  next.known.light_doublings = std::move(to_lights.of_patch);
  next.known.row_doublings = std::move(of_rows.of_patch);
  return next;
}

std::string note_on_local_cuts(const MeshToSolve& next, const AccuracyStep& errors) {
  const std::vector<PatchIndex>& place = next.known.place;
  const auto cut =
      errors.patches - (place.size() - static_cast<std::size_t>(std::count(place.begin(), place.end(), no_patch)));
  const auto is_doubled = [&](std::size_t i) {
    const auto any = [i](const std::vector<std::uint8_t>& doublings) { return !doublings.empty() && doublings[i] > 0; };
    return any(next.known.light_doublings) || any(next.known.row_doublings);
  };
  std::size_t doubled = 0;
  for (std::size_t i = 0; i < place.size(); ++i) doubled += is_doubled(i) ? 1 : 0;
  const std::string cuts = cut > 0 ? std::to_string(cut) + " of them are cut" : "";
  const std::string rays = doubled > 0 ? std::to_string(doubled) + " patches take more rays" : "";
  return "the first mesh, of " + std::to_string(errors.patches) + " patches, errs by " + percent(errors.total, 2) +
         " %: on a second one " + cuts + (cuts.empty() || rays.empty() ? "" : ", and ") + rays +
         "; accuracy.local_cuts=false stays with the first";
}

}  // namespace patchlight
