#include "pipeline/with_error_bars.h"

#include "patchlight/transport/transport_operator.h"

#include "accuracy/errors.h"
#include "accuracy/refinement.h"
#include "accuracy/spaces.h"
#include "accuracy/unseen_differences.h"
#include "base/sampling.h"
#include "base/vectors.h"
#include "mesh/interpolate.h"
#include "mesh/nested_mesh.h"
#include "pipeline/local_cuts.h"
#include "pipeline/problem_of.h"
#include "pipeline/radiosity_errors.h"
#include "pipeline/solved.h"
#include "plan/goal.h"
#include "transport/closure.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Rays from each quarter of a patch: enough to see into gaps narrower than patches.
constexpr int rays_from_quarters = 8;

// Fewer rays where there are many patches, for the sake of time: the mean over the patches around reduces the noise.
// More where rows have more, and up to 16 for an accuracy below 10 %, as the bars have to be smaller.
int rays_of_quarters(const Plan& plan, PatchIndex patches) {
  if (plan.assembly.storage != Storage::rays) return rays_from_quarters;
  const int usual = patches > very_many_patches ? 2 : patches > many_patches ? 4 : rays_from_quarters;
  const std::optional<double>& asked = plan.accuracy.relative_error;
  const double of_rows = static_cast<double>(plan.assembly.rays) / AssemblyOptions().rays;
  const double of_accuracy = asked ? std::min(16.0 / usual, 0.1 / *asked) : 1;
  return usual * static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max({1.0, of_rows, of_accuracy}))));
}

// unseen_differences() of a simulation in all bands, including those of luminaires, sun and sky. `needed` is the
// simulation in the needed bands. Throws Canceled.
UnseenDifferences unseen_differences_of(const Run& run, const Simulation& simulation, const QuarterLight& light,
                                        const InNeededBands& needed, const TransportOperator& transport,
                                        const Eigen::VectorXd& weight) {
  QuarterLook look{.rays = rays_of_quarters(simulation.plan, simulation.mesh.size()),
                   .seed = simulation.plan.assembly.seed};
  for (std::size_t half = 0; half < light.size(); ++half)
    if (light[half].size() > 0) look.direct[half] = reduced(light[half], needed.bands);
  const SolvedProblem solved = needed.solved();
  UnseenDifferences unseen =
      unseen_differences({simulation.mesh, run.world->between_patches(), simulation.transport.lost, solved}, transport,
                         weight, look, run.observer);
  for (Field* field : {&unseen.error, &unseen.noise, &unseen.display}) *field = expanded(*field, needed.bands);
  return unseen;
}

// The same light on the parents, with the exchange areas of their patches summed up.
Field radiosity_of_parents(ClosedExchangeAreas of_parents, const NestedMesh& mesh, const Plan& plan,
                           const RadiosityProblem& problem) {
  const RadiosityProblem coarse = problem_of_parents(mesh, problem);
  SolverOptions options = plan.solver;
  const auto transport = dense_transport(std::move(of_parents), coarse.area);
  options.solver = usual_solver(*transport, coarse);
  options.max_rows.reset();
  options.patch_bounds = false;
  return solve(*transport, coarse, options).radiosity;
}

// Draws of the irradiance error by sampled form factors, in all bands.
std::vector<Field> draw_sampling_errors(const Assembly& raw, const RowTransport& transport,
                                        const SolvedProblem& solved) {
  const InNeededBands needed = in_needed_bands(solved);
  std::vector<Field> draws =
      draw_form_factor_errors(raw.half_differences, transport, {needed.problem, needed.solution, solved.closed});
  for (Field& draw : draws) draw = expanded(draw, needed.bands);
  return draws;
}

// The errors of the irradiance by errors of the exposed shares of patches. Closure brings the entries of a row to the
// sum that follows from that share, and changes them in proportion to their squares. So light of other patches takes
// the same part of the error as the row. Only the difference of the changing patches' light from the mean counts.
Field errors_of_exposure(const Simulation& simulation, const ExchangeAreas& S, const SolvedProblem& solved) {
  const Field& irradiance = solved.solution.irradiance;
  const Eigen::ArrayXd relative = exposure_errors(simulation.transport.lost);
  if (!solved.closed || relative.isZero(0)) return irradiance.colwise() * relative;
  const Field& B = solved.solution.radiosity;
  Field x(B.rows(), B.cols() + 1);
  x << B, Field::Ones(B.rows(), 1);
  const Field changed = multiply(S, x, 2);
  const Eigen::ArrayXd sum = changed.rightCols(1).col(0);
  const Field& direct = solved.problem.direct_irradiance;
  const Field by_patches = direct.size() > 0 ? Field(irradiance - direct) : irradiance;
  const Field mean = (sum > 0).replicate(1, B.cols()).select(changed.leftCols(B.cols()).colwise() / sum, 0.0);
  Field off = (by_patches - mean).abs();
  if (direct.size() > 0) off += direct;
  return off.colwise() * relative;
}

// The errors by the size of the patches, by source.
struct MeshBars {
  Field from_larger;         // of sources that are not even
  UnseenDifferences unseen;  // of light that differs inside patches
  Field in_gaps;             // of gaps that are narrower than their patches
  Field dark;                // radiosity that patches lose where they reach into solids
  Field by_dark_parts;       // and the error of the irradiance by it

  Field total() const {
    return (from_larger.max(unseen.error).square() + in_gaps.square() + by_dark_parts.square()).sqrt();
  }
};

MeshBars mesh_bars(const Run& run, const SolvedMesh& result, const RowTransport& transport, const SolvedProblem& solved,
                   const Eigen::VectorXd& weight, ClosedExchangeAreas of_parents) {
  const Simulation& simulation = result.simulation;
  const Field coarse = radiosity_of_parents(std::move(of_parents), result.mesh, simulation.plan, solved.problem);
  Field dark = dark_differences(simulation.transport.lost, solved);
  Field by_dark_parts = transport.apply(dark);
  return {mesh_errors(result.mesh, transport, solved, coarse),
          unseen_differences_of(run, simulation, light_at_quarters(run, simulation.plan, simulation.mesh),
                                in_needed_bands(solved), transport, weight),
          gap_errors(simulation.mesh, result.raw->exchange_areas, solved), std::move(dark), std::move(by_dark_parts)};
}

// Effects to a factor as shares of the squares of the error that they explain.
Eigen::VectorXd scaled_to(const Eigen::VectorXd& squares, const Eigen::VectorXd& effects) {
  const double sum = total(effects);
  return sum > 0 ? Eigen::VectorXd(total(squares) / sum * effects) : effects;
}

// How much the light on each patch matters.
Eigen::VectorXd weight_for(const TransportOperator& transport, const RadiosityProblem& problem,
                           const Eigen::VectorXd& interest) {
  return interest.minCoeff() == 1 ? interest : importance(transport, problem, interest);
}

// The sources' effects as shares of the errors that they explain, and the errors of gaps, which are their own.
Eigen::VectorXd effects_of(const SolvedMesh& result, const SolvedProblem& solved, const Eigen::VectorXd& weight,
                           const MeshBars& bars) {
  const auto squares = [&](const Field& bar) { return squares_of_parents(result.mesh, solved, bar, weight); };
  const auto shared_out = [&](const Field& bar, const Field& difference) {
    return scaled_to(squares(bar),
                     effects_of_parents(result.raw->exchange_areas, result.mesh, solved, {difference, weight}));
  };
  const Eigen::VectorXd unseen = summed_by_parent(result.mesh, bars.unseen.effects.array()).col(0).matrix();
  return shared_out(bars.from_larger, differences_from_parents(result.mesh, solved)) +
         shared_out(bars.by_dark_parts, bars.dark) + squares(bars.in_gaps) +
         scaled_to(squares(bars.unseen.error), unseen.cwiseMax(0.0));
}

// The errors by the size of the patches, by rows of rays.
struct BarsOfRays {
  Field of_light;        // that differs inside patches and parents
  Field in_gaps;         // that are narrower than their patches
  Field in_narrow_gaps;  // those narrower even than patches that are cut as often as on a second mesh; empty where more
                         // meshes may follow
};

// Errors by light over mirrors that is not followed, which no more rays reduce.
struct UnfollowedErrors {
  Field of_lights;  // luminaires, sun and sky
  Field of_rows;    // separate emitters; empty where there are none
};

// The effects of refinement: of parents by the light of their patches, and by errors in gaps, which are their own; none
// by noise, which more rays take away.
SolvedMesh with_effects(SolvedMesh result, const Eigen::VectorXd& weight, const UnseenDifferences& unseen,
                        const BarsOfRays& bars) {
  const SolvedProblem solved{result.simulation.problem, result.simulation.solution};
  const auto is_of_gap = bars.in_gaps > bars.of_light;
  const Field of_light = is_of_gap.select(0.0, bars.of_light);
  const Field of_gaps = is_of_gap.select(bars.in_gaps, 0.0);
  const auto squares = [&](const Field& bar) { return squares_of_parents(result.mesh, solved, bar, weight); };
  result.effects =
      scaled_to(squares(of_light), summed_by_parent(result.mesh, unseen.effects.array()).col(0).matrix().cwiseMax(0.0));
  const Eigen::VectorXd in_gaps = squares(of_gaps);
  const double all = result.effects.sum() + in_gaps.sum();
  // Errors that remain after so many cuts do not count.
  if (bars.in_narrow_gaps.size() > 0)
    result.effects += (in_gaps - squares(is_of_gap.select(bars.in_narrow_gaps, 0.0))).cwiseMax(0.0);
  else
    result.effects += in_gaps;
  result.share_cuts_mend = all > 0 ? result.effects.sum() / all : 0;
  result.noise = Eigen::VectorXd::Zero(result.effects.size());
  return result;
}

// The errors by rays of rows and to lights, which more rays reduce.
SolvedMesh with_noise(SolvedMesh result, const Eigen::VectorXd& weight, const UnfollowedErrors& unfollowed) {
  const Simulation& simulation = result.simulation;
  const SolvedProblem solved{simulation.problem, simulation.solution};
  const auto relative = [&](const Field& bar) {
    return relative_bar(bar, simulation.problem, simulation.solution, result.interest);
  };
  const auto of_each = [&](const Field& bar) { return squares_of_patches(solved, bar, weight); };
  Field of_rows = simulation.ray_standard_error.square();
  if (unfollowed.of_rows.size() > 0) of_rows -= unfollowed.of_rows.square();
  const Field& of_lights = simulation.direct_standard_error;
  if (of_lights.size() > 0) {
    // The exposed share of a patch is an error of rows.
    const Field by_exposure =
        simulation.problem.direct_irradiance.colwise() * exposure_errors(simulation.transport.lost);
    const Field bound = unfollowed.of_lights.square().min(of_lights.square());
    const Field by_rays = (of_lights.square() - by_exposure.square() - bound).max(0.0);
    of_rows -= by_rays + bound;
    result.light_noise = of_each(by_rays.sqrt());
    result.light_bar = relative(by_rays.sqrt());
  }
  of_rows = of_rows.max(0.0).sqrt();
  result.row_noise = of_each(of_rows);
  result.noise_bar = relative(of_rows);
  return result;
}

// Rows of rays have their own error estimate; rays at quarters of patches find the part of the mesh.
SolvedMesh with_bars_of_rays(const Run& run, SolvedMesh result, const RaysWithPockets& transport,
                             const QuarterLight& light, const UnfollowedErrors& unfollowed) {
  // Known rows allow no further ray.
  if (!simulates(run.plan, Effect::interreflection) || run.with.ray_exchange) return result;
  Simulation& simulation = result.simulation;
  const SolvedProblem solved{simulation.problem, simulation.solution};
  result.interest = interest_in(run.scene, simulation);
  if (!run.is_part) require_reflecting(run.scene, simulation.problem, result.interest);
  const Eigen::VectorXd weight = weight_for(transport, solved.problem, result.interest);
  const InNeededBands needed = in_needed_bands(solved);
  const UnseenDifferences unseen = unseen_differences_of(run, simulation, light, needed, transport, weight);
  const auto within_parents = [&] {
    return expanded(errors_within_parents(result.mesh, transport.rays(), needed.solved()), needed.bands);
  };
  const bool has_parents = result.mesh.parents.size() > 0;
  const auto in_gaps = [&](int cuts) { return gap_errors(simulation.mesh, transport.rays(), solved, cuts); };
  BarsOfRays bars{has_parents ? Field(unseen.error.max(within_parents())) : unseen.error, in_gaps(0), {}};
  // Errors in gaps are differences of light inside their patches: of both the larger one counts.
  const Field of_mesh = bars.of_light.max(bars.in_gaps);
  // Larger errors by parents or gaps are not noise.
  const Field by_noise = (unseen.error >= of_mesh).select(unseen.noise, 0.0);
  simulation.error_bars = {.mesh = of_mesh,
                           .mesh_noise = by_noise,
                           .form_factor = simulation.ray_standard_error,
                           .solver = solver_errors(solved),
                           .display = unseen.display};
  if (!has_parents || !cuts_locally(run, simulation.mesh.size())) return result;
  if (!refines(run.plan.accuracy)) bars.in_narrow_gaps = in_gaps(most_local_cuts);
  return with_noise(with_effects(std::move(result), weight, unseen, bars), weight, unfollowed);
}

// Pairs have errors of their entries.
SolvedMesh with_bars_of_pairs(const Run& run, SolvedMesh result, MeshTransport transport) {
  if (!run.plan.accuracy.error_bars) return result;
  result.raw = std::move(transport.assembly);
  const RowTransport& rows = *transport.rows;
  Simulation& simulation = result.simulation;
  const PatchMesh& mesh = simulation.mesh;
  const LostShare& lost = simulation.transport.lost;
  const SolvedProblem solved{simulation.problem, simulation.solution, lost.closed() && simulation.plan.assembly.close};

  // 1. The patches of interest.
  result.interest = interest_in(run.scene, simulation);
  require_reflecting(run.scene, simulation.problem, result.interest);
  const Eigen::VectorXd weight = weight_for(rows, solved.problem, result.interest);

  // 2. The errors by patches, samples and solver.
  const MeshBars of_mesh = mesh_bars(run, result, rows, solved, weight, std::move(*transport.of_parents));
  std::vector<Field> draws = draw_sampling_errors(*result.raw, rows, solved);
  // The difference of a single pair is noisy.
  const Field sampled = means_around(mesh, solved.problem.area, mean_square(draws).sqrt());
  Field squares = sampled.square() + errors_of_exposure(simulation, result.raw->exchange_areas, solved).square();
  if (has_point_or_daylight(run.scene)) {
    const Field& of_lights = simulation.direct_standard_error;
    const std::vector<Field> by_lights = draw_errors_of_lights(mesh, rows, solved.problem, of_lights);
    // The error of a patch's own direct light is known without draws.
    squares += mean_square(by_lights).max(of_lights.square());
    for (std::size_t k = 0; k < draws.size(); ++k) draws[k] += by_lights[k];
  }
  simulation.correlated_errors = std::move(draws);
  simulation.error_bars = {.mesh = of_mesh.total(),
                           .mesh_noise = {},
                           .form_factor = squares.sqrt(),
                           .solver = solver_errors(solved),
                           .display = display_errors(result.mesh, solved).max(of_mesh.unseen.display)};

  // 3. Their sources.
  result.effects = effects_of(result, solved, weight, of_mesh);
  if (has_point_or_daylight(run.scene)) {
    // The edge of the sun's light crosses fewer patches, by area, when these are finer.
    const Field& of_lights = simulation.direct_standard_error;
    result.effects += squares_of_parents(result.mesh, solved, of_lights, weight);
    result.light_bar = relative_bar(of_lights, simulation.problem, simulation.solution, result.interest);
  }
  result.noise_bar = relative_bar(sampled, simulation.problem, simulation.solution, result.interest);
  result.noise = noise_of_parents(result.raw->half_differences, result.mesh, solved, weight);
  return result;
}

}  // namespace

QuarterLight light_at_quarters(const Run& run, const Plan& plan, const PatchMesh& mesh) {
  if (!has_point_or_daylight(run.scene) || !simulates(run.plan, Effect::interreflection)) return {};
  const double least_area = mean_area_of_goal(mesh, plan.goal.get()) / 64;
  std::vector<std::uint8_t> is_left_out;
  for (const double area : mesh.area) is_left_out.insert(is_left_out.end(), 4, area < least_area ? 1 : 0);
  PatchMesh all = refine(mesh);
  all.middles.clear();  // they belong to edges, on which light does not depend
  const PatchMesh quarters = without_patches(all, is_left_out);
  QuarterLight direct;
  for (std::size_t half = 0; half < direct.size(); ++half) {
    const std::uint64_t seed = hash({plan.assembly.seed, half});
    const Field found = rough_direct_irradiance(run, plan, quarters, seed, rays_of_quarters(plan, mesh.size()));
    direct[half] = Field::Zero(static_cast<Eigen::Index>(is_left_out.size()), found.cols());
    Eigen::Index next = 0;
    for (std::size_t q = 0; q < is_left_out.size(); ++q)
      if (is_left_out[q] == 0) direct[half].row(static_cast<Eigen::Index>(q)) = found.row(next++);
  }
  return direct;
}

SolvedMesh with_error_bars(const Run& run, SolvedMesh result, MeshTransport transport,
                           std::optional<QuarterLight> light) {
  if (transport.rays) {
    // The solution has all of the light but the rows.
    RayLight& with_rows = *transport.light;
    result.light = std::move(with_rows.as_found);
    const UnfollowedErrors unfollowed{std::move(with_rows.lit.unfollowed), std::move(with_rows.in_mirrors.unfollowed)};
    transport.light.reset();
    transport.facts = {};
    if (!light && !run.with.ray_exchange)
      light = light_at_quarters(run, result.simulation.plan, result.simulation.mesh);
    return with_bars_of_rays(run, std::move(result), *transport.rays, light.value_or(QuarterLight()), unfollowed);
  }
  return with_bars_of_pairs(run, std::move(result), std::move(transport));
}

}  // namespace patchlight
