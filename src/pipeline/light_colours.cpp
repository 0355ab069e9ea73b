#include "pipeline/light_colours.h"

#include "accuracy/spaces.h"
#include "light/photometry.h"
#include "pipeline/local_cuts.h"
#include "pipeline/mesh_transport.h"
#include "pipeline/problem_of.h"
#include "pipeline/solved.h"
#include "pipeline/with_error_bars.h"
#include "plan/planned_scene.h"
#include "scene/spectral_bands.h"

#include <algorithm>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// Columns of all bands from those of some.
struct IntoBands {
  const std::vector<Eigen::Index>& bands;
  Eigen::Index all;

  void put(Field& into, const Field& from) const {
    if (from.size() == 0) return;
    if (into.size() == 0) into = Field::Zero(from.rows(), all);
    into(Eigen::all, bands) = from;
  }
  void put(Eigen::ArrayXd& into, const Eigen::ArrayXd& from) const {
    if (into.size() == 0) into = Eigen::ArrayXd::Zero(all);
    into(bands) = from;
  }
};

void put_problem(RadiosityProblem& into, const RadiosityProblem& from, const IntoBands& bands) {
  into.scattering.other_side = from.scattering.other_side;
  bands.put(into.scattering.reflectance, from.scattering.reflectance);
  bands.put(into.scattering.transmittance, from.scattering.transmittance);
  bands.put(into.exitance, from.exitance);
  bands.put(into.direct_irradiance, from.direct_irradiance);
}

Iteration worst(Iteration a, const Iteration& b) {
  a.number = std::max(a.number, b.number);
  a.relative_residual = std::max(a.relative_residual, b.relative_residual);
  a.error_bound = std::max(a.error_bound, b.error_bound);
  a.seconds += b.seconds;
  a.work = std::max(a.work, b.work);
  return a;
}

// Step by step; an iteration that has ended keeps its last step.
std::vector<Iteration> worst(std::vector<Iteration> a, const std::vector<Iteration>& b) {
  if (a.empty() || b.empty()) return a.empty() ? b : a;
  const std::size_t steps = std::max(a.size(), b.size());
  a.resize(steps, a.back());
  for (std::size_t k = 0; k < steps; ++k) a[k] = worst(a[k], b[std::min(k, b.size() - 1)]);
  return a;
}

void put_solution(Solution& into, const Solution& from, const IntoBands& bands, bool is_first) {
  for (const auto field : {&Solution::radiosity, &Solution::irradiance, &Solution::direct_irradiance, &Solution::error})
    bands.put(into.*field, from.*field);
  into.history = worst(std::move(into.history), from.history);
  into.converged = from.converged && (is_first || into.converged);
  into.stopped = into.stopped || from.stopped;
  if (into.trapped.empty()) into.trapped = from.trapped;
  into.patch_bound = is_first ? from.patch_bound : std::max(into.patch_bound, from.patch_bound);
}

void put_balance(EnergyBalance& into, const EnergyBalance& from, const IntoBands& bands) {
  for (const auto flux : {&EnergyBalance::emitted, &EnergyBalance::arriving, &EnergyBalance::absorbed,
                          &EnergyBalance::escaped, &EnergyBalance::lost_at_backs, &EnergyBalance::defect})
    bands.put(into.*flux, from.*flux);
  into.imbalance = std::max(into.imbalance, from.imbalance);
}

void put_bars(std::optional<ErrorBars>& into, const std::optional<ErrorBars>& from, const IntoBands& bands) {
  if (!from) return;
  if (!into) into.emplace();
  for (const auto bar :
       {&ErrorBars::mesh, &ErrorBars::mesh_noise, &ErrorBars::form_factor, &ErrorBars::solver, &ErrorBars::display})
    bands.put((*into).*bar, (*from).*bar);
}

void add(Eigen::VectorXd& sum, double weight, const Eigen::VectorXd& part) {
  if (part.size() == 0) return;
  if (sum.size() == 0) sum = Eigen::VectorXd::Zero(part.size());
  sum += weight * part;
}

// Adds the facts with one number per patch.
void add_facts(TransportFacts& sum, double weight, const TransportFacts& part) {
  add(sum.row_sum, weight, part.row_sum);
  for (const auto share :
       {&LostShare::escaped, &LostShare::at_backs, &LostShare::covered, &LostShare::dark, &LostShare::overlaid})
    add(sum.lost.*share, weight, part.lost.*share);
  sum.lost.rays_per_patch = part.lost.rays_per_patch;
  sum.lost.doublings = part.lost.doublings;
  sum.counts.shadow_rays += part.counts.shadow_rays;
  sum.closure = part.closure;
}

void add_effects(SolvedMesh& sum, const SolvedMesh& part) {
  sum.interest = part.interest;
  for (const auto effect : {&SolvedMesh::effects, &SolvedMesh::noise, &SolvedMesh::row_noise, &SolvedMesh::light_noise})
    add(sum.*effect, 1, part.*effect);
  sum.share_cuts_mend = std::max(sum.share_cuts_mend, part.share_cuts_mend);
  sum.noise_bar = std::max(sum.noise_bar, part.noise_bar);
  sum.light_bar = std::max(sum.light_bar, part.light_bar);
}

// The solution in all bands of a run from those in each color: columns next to each other, means by luminance of
// numbers for all bands, and the worst errors and counts of iterations.
SolvedMesh joined(const Run& run, const std::vector<LightColour>& colours, const MeshToSolve& meshed,
                  std::vector<SolvedMesh> parts) {
  SolvedMesh all{{}, meshed.mesh};
  Simulation& into = all.simulation;
  into.plan = meshed.plan;
  into.notes = run.notes;
  into.mesh = meshed.mesh.patches;
  into.world = run.world;
  into.enclosed = parts.front().simulation.enclosed;
  const Bands bands = bands_of(run.scene);
  const Spectrum shares = luminous_shares(bands);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    add_effects(all, parts[k]);
    // The geometric area of a patch is the same in all colors. The effective area is not.
    const Simulation part = to_geometric_area(std::move(parts[k].simulation), colours[k].world->planned_scene());
    const IntoBands columns{colours[k].bands, static_cast<Eigen::Index>(bands.size())};
    const double weight = shares(colours[k].bands).sum();
    put_problem(into.problem, part.problem, columns);
    add(into.problem.area, weight, part.problem.area);
    put_solution(into.solution, part.solution, columns, k == 0);
    put_balance(into.balance, part.balance, columns);
    put_bars(into.error_bars, part.error_bars, columns);
    columns.put(into.direct_standard_error, part.direct_standard_error);
    columns.put(into.ray_standard_error, part.ray_standard_error);
    into.correlated_errors.resize(std::max(into.correlated_errors.size(), part.correlated_errors.size()));
    for (std::size_t draw = 0; draw < part.correlated_errors.size(); ++draw)
      columns.put(into.correlated_errors[draw], part.correlated_errors[draw]);
    add_facts(into.transport, weight, part.transport);
    for (SolvedTransport kept : part.transports) {
      kept.bands = colours[k].bands;
      into.transports.push_back(std::move(kept));
    }
    const double tolerance = part.plan.solver.relative_error.value_or(default_tolerance);
    into.plan.solver.relative_error = k == 0 ? tolerance : std::min(tolerance, *into.plan.solver.relative_error);
  }
  into.transport.lost.clear = clear_shares(into.mesh, run.world->between_patches());
  all.simulation = to_effective_area(std::move(all.simulation), run.scene);
  return all;
}

// The spectra of all clear faces and mirrors.
std::vector<Spectrum> specular_spectra(const Scene& scene, Reflections reflections) {
  std::set<MaterialIndex> clear, mirrors;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const bool is_clear = is_opening(scene, p);
    for (const Side side : {Side::front, Side::back}) {
      const MaterialIndex material = material_on(scene.polygons[p], side);
      if (is_clear) clear.insert(material);
      if (!is_clear && is_mirror(scene, p, side) && reflections == Reflections::followed) mirrors.insert(material);
    }
  }
  std::vector<Spectrum> spectra;
  for (const MaterialIndex m : clear) spectra.push_back(scene.materials[m].transmittance);
  for (const MaterialIndex m : mirrors) spectra.push_back(scene.materials[m].specular_reflectance);
  return spectra;
}

// A plan for some of its bands.
Plan in_bands(Plan plan, const std::vector<Eigen::Index>& bands) {
  if (plan.lamp_colour.size() == 0) return plan;
  const Spectrum chosen = plan.lamp_colour(bands);
  plan.lamp_colour = (chosen > 0).any() ? chosen : Spectrum();
  return plan;
}

}  // namespace

std::vector<LightColour> light_colours(const Run& run) {
  if (run.plan.assembly.storage != Storage::rays || !run.world->tracing().has_specular_surfaces()) return {};
  const Reflections reflections = run.world->tracing().reflections();
  const auto groups = alike_bands(specular_spectra(run.scene, reflections), number_of_bands(run.scene));
  if (groups.size() < 2) return {};
  std::vector<LightColour> colours;
  for (const std::vector<Eigen::Index>& bands : groups)
    colours.push_back({bands, run.world->in_bands(bands, in_bands(run.plan, bands))});
  return colours;
}

SolvedMesh solved_in_colours(const Run& run, const std::vector<LightColour>& colours, const MeshToSolve& meshed,
                             StageClock& clock) {
  const ExchangeAndLight all_bands = exchange_and_light(run, meshed.plan, meshed.mesh.patches, meshed.known);
  clock.finish(Stage::form_factors);
  QuarterLight light;
  if (!run.with.ray_exchange) light = light_at_quarters(run, meshed.plan, meshed.mesh.patches);
  clock.finish(Stage::error_bars);
  std::vector<SolvedMesh> parts;
  for (const LightColour& colour : colours) {
    const Plan plan = in_bands(run.plan, colour.bands);
    const Run part{
        colour.world->planned_scene(), run.request, plan, run.notes, colour.world, run.with, run.observer, true};
    const MeshToSolve in_part{meshed.mesh, in_bands(meshed.plan, colour.bands), {}};
    const PatchMesh& mesh = in_part.mesh.patches;
    RawTransport raw =
        raw_transport(ray_light(part, mesh, in_colour(all_bands, colour.bands, part, in_part.plan, mesh)));
    MeshTransport transport = closed_transport(part, in_part.plan, in_part.mesh, std::move(raw));
    LitProblem problem = transport.light->lit;
    clock.finish(Stage::closure);
    Simulation simulation = solved(part, in_part, transport, std::move(problem));
    clock.finish(Stage::solve);
    QuarterLight of_colour;
    for (std::size_t half = 0; half < light.size(); ++half) of_colour[half] = columns_of(light[half], colour.bands);
    parts.push_back(
        with_error_bars(part, {std::move(simulation), in_part.mesh}, std::move(transport), std::move(of_colour)));
    clock.finish(Stage::error_bars);
  }
  SolvedMesh all = joined(run, colours, meshed, std::move(parts));
  const LitProblem& lit = all_bands.light.lit;
  if (cuts_locally(run, meshed.mesh.patches.size()) && lit.direct_standard_error.size() > 0)
    all.light = {lit.problem.direct_irradiance, lit.direct_standard_error, lit.unfollowed};
  if (all.interest.size() > 0) require_reflecting(run.scene, all.simulation.problem, all.interest);
  return all;
}

}  // namespace patchlight
