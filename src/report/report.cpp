#include "patchlight/report/report.h"

#include "accuracy/errors.h"
#include "report/room_light.h"
#include "solve/scattering.h"
#include "transport/closure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace patchlight {
namespace {

std::optional<double> ray_error(const Simulation& simulation) {
  if (simulation.ray_standard_error.size() == 0) return std::nullopt;
  return relative_bar(simulation.ray_standard_error, simulation.problem, simulation.solution,
                      Eigen::VectorXd::Ones(simulation.ray_standard_error.rows()));
}

SceneFacts scene_facts(const Scene& scene) {
  return {.file = scene.file,
          .sha256 = scene.sha256,
          .polygons = scene.polygons.size(),
          .materials = scene.materials.size(),
          .metres_per_unit = scene.metres_per_unit,
          .up = scene.up,
          .up_stated = scene.up_stated,
          .size = bounds(scene).diagonal(),
          .warnings = chosen(scene.diagnostics, makes_results_wrong),
          .notes = remarks_of(scene),
          .bands = bands_of(scene)};
}

std::vector<MaterialLight> material_light(const Scene& scene, const Simulation& simulation) {
  const Field& irradiance = simulation.solution.irradiance;
  const Field absorbed = absorb(simulation.problem.scattering, irradiance);
  const Spectrum zero = Spectrum::Zero(irradiance.cols());
  const Spectrum infinite = Spectrum::Constant(irradiance.cols(), std::numeric_limits<double>::infinity());
  std::vector<MaterialLight> all;
  for (const Material& material : scene.materials) {
    all.push_back({.name = material.name,
                   .reflectance = material.reflectance,
                   .exitance = material.exitance,
                   .emitted = zero,
                   .absorbed = zero,
                   .lowest = infinite,
                   .mean = zero,
                   .highest = -infinite,
                   .radiance = zero});
  }
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    MaterialLight& of_material = all[simulation.mesh.material[i]];
    const double area = simulation.problem.area[i];
    of_material.area += area;
    of_material.emitted += area * simulation.problem.exitance.row(i);
    of_material.mean += area * irradiance.row(i);
    of_material.radiance += area / std::numbers::pi * simulation.solution.radiosity.row(i);  // L = B / pi
    of_material.absorbed += area * absorbed.row(i);
    of_material.lowest = of_material.lowest.min(irradiance.row(i));
    of_material.highest = of_material.highest.max(irradiance.row(i));
  }
  for (MaterialLight& of_material : all) {
    of_material.mean /= of_material.area;
    of_material.radiance /= of_material.area;
  }
  return all;
}

SamplingFacts::Unanimous unanimous_facts(const SamplingError::Unanimous& unanimous) {
  return {unanimous.pairs(), unanimous.missed, bound_on_miss(unanimous)};
}

std::optional<SamplingFacts> sampling_facts(const SamplingError& error) {
  if (!was_audited(error)) return {};
  SamplingFacts facts{.half_hidden = standard_error(error, 0.5),
                      .visible = unanimous_facts(error.visible),
                      .occluded = unanimous_facts(error.occluded)};
  for (std::size_t bin = 0; bin < SamplingError::bins; ++bin) {
    const double share = (static_cast<double>(bin) + 0.5) / SamplingError::bins;
    facts.partial[bin] = {share, with_visible_share(error, bin).pairs, standard_error(error, share)};
  }
  return facts;
}

std::optional<RowSumFacts> row_sum_facts(const Eigen::VectorXd& row_sum, const Simulation& simulation) {
  if (row_sum.size() == 0) return {};
  const Eigen::ArrayXd& area = simulation.problem.area.array();
  const Eigen::ArrayXd defect = (row_sum - expected_row_sum(simulation.transport.lost)).array();
  return RowSumFacts{.min = row_sum.minCoeff(),
                     .mean = (area * row_sum.array()).sum() / area.sum(),
                     .max = row_sum.maxCoeff(),
                     .rms_defect = std::sqrt((area * defect.square()).sum() / area.sum())};
}

std::vector<WorstPatch> worst_patches(const Scene& scene, const Simulation& simulation) {
  constexpr std::size_t count = 5;
  const PatchMesh& mesh = simulation.mesh;
  std::vector<WorstPatch> worst;
  for (const RowDefect& row :
       worst_rows(simulation.transport.raw_row_sum, simulation.transport.lost, simulation.problem.area, count)) {
    const Polygon& polygon = scene.polygons[mesh.polygon[row.patch]];
    worst.push_back({.patch = row.patch,
                     .place = place_of(scene, polygon),
                     .face = polygon.face,
                     .group = group_name(scene, polygon.group),
                     .material = scene.materials[mesh.material[row.patch]].name,
                     .centre = mesh.centroid[row.patch],
                     .area = simulation.problem.area[row.patch],
                     .row_sum = row.row_sum,
                     .expected = row.expected});
  }
  return worst;
}

double seconds_of(const std::vector<StageCost>& costs, Stage stage) {
  double seconds = 0;
  for (const StageCost& cost : costs) seconds += cost.stage == stage ? cost.seconds : 0;
  return seconds;
}

FormFactorFacts form_factor_facts(const Scene& scene, const Simulation& simulation) {
  const TransportFacts& transport = simulation.transport;
  const Eigen::VectorXd& area = simulation.problem.area;
  FormFactorFacts facts;
  if (keeps_entries(simulation.plan.assembly.storage)) facts.counts = transport.counts;
  const double seconds = seconds_of(simulation.costs, Stage::form_factors);
  if (seconds > 0) facts.rays_per_second = static_cast<double>(transport.counts.shadow_rays) / seconds;
  facts.bare_rays_per_second = transport.bare_rays_per_second;
  facts.sampling = sampling_facts(transport.error);
  facts.lost_share_rays = static_cast<std::uint64_t>(rays_of_patches(transport.lost, simulation.mesh.size()).sum());
  facts.ray_error = ray_error(simulation);
  facts.closure = transport.closure;
  facts.raw_row_sum = row_sum_facts(transport.raw_row_sum, simulation);
  facts.row_sum = row_sum_facts(transport.row_sum, simulation);
  facts.worst = worst_patches(scene, simulation);
  facts.escaped = area.dot(transport.lost.escaped) / area.sum();
  facts.at_backs = area.dot(transport.lost.at_backs) / area.sum();
  return facts;
}

bool stopped_by_rows(const Simulation& simulation) {
  const SolverOptions& options = simulation.plan.solver;
  const Solution& solution = simulation.solution;
  if (solution.converged || solution.stopped || !solution.trapped.empty() || solution.history.empty()) return false;
  const auto shots = static_cast<double>(solution.history.back().number);
  return options.max_rows && shots < static_cast<double>(options.max_iterations) * simulation.mesh.size();
}

SolutionFacts solution_facts(const Simulation& simulation) {
  const Solution& solution = simulation.solution;
  return {.converged = solution.converged,
          .trapped = solution.trapped,
          .patch_bound = solution.patch_bound,
          .history = solution.history,
          .highest_reflectance = simulation.problem.scattering.reflectance.maxCoeff(),
          .stopped_by_rows = stopped_by_rows(simulation),
          .unfinished = simulation.unfinished};
}

}  // namespace

const char* name_of(RoomSurface surface) {
  switch (surface) {
    case RoomSurface::floor:
      return "floor";
    case RoomSurface::walls:
      return "walls";
    case RoomSurface::ceiling:
      return "ceiling";
  }
  return "";
}

SensorFacts sensor_facts(std::span<const SensorGroup> groups, const Readings& readings, Diagnostics warnings) {
  return {.groups = by_group(groups, readings),
          .unit = sensor_unit(readings),
          .daylight = readings.outside_by_sky.has_value(),
          .warnings = std::move(warnings)};
}

Report report_of(const Scene& scene, const Request& request, const Simulation& simulation, SensorFacts sensors) {
  return {.scene = scene_facts(scene),
          .request = request,
          .plan = simulation.plan,
          .notes = simulation.notes,
          .patches = simulation.mesh.size(),
          .vertices = simulation.mesh.vertices.size(),
          .area = simulation.problem.area.sum(),
          .materials = material_light(scene, simulation),
          .rooms = room_light(scene, simulation),
          .unit = scene.photometric ? "lx" : "W/m^2",
          .sensors = std::move(sensors),
          .form_factors = form_factor_facts(scene, simulation),
          .balance = simulation.balance,
          .solution = solution_facts(simulation),
          .accuracy = simulation.accuracy,
          .spaces = simulation.spaces,
          .costs = simulation.costs};
}

bool is_accurate(const Report& report) {
  const std::optional<double>& asked = report.plan.accuracy.relative_error;
  return !asked || (!report.accuracy.empty() && report.accuracy.back().total <= *asked);
}

}  // namespace patchlight
