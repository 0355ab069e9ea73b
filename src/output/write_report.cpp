#include "patchlight/output/write_report.h"

#include "output/accuracy_json.h"
#include "output/decisions_part.h"
#include "output/json_array.h"
#include "output/sensors_part.h"
#include "output/write_bytes.h"
#include "transport/worst_rows.h"

#include <limits>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace patchlight {
namespace {

// Keeps the keys in the order in which they are set. Numbers that are not finite are written as null.
using Json = nlohmann::ordered_json;

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(); }
Json json_of(const std::optional<std::size_t>& value) { return value ? Json(*value) : Json(); }

Json input_part(const Scene& scene) {
  Json part;
  part["file"] = scene.file;
  part["sha256"] = scene.sha256;
  part["polygons"] = scene.polygons.size();
  part["materials"] = scene.materials.size();
  part["metres_per_unit"] = scene.metres_per_unit;
  part["up"] = json_array(scene.up);
  part["notes"] = scene.notes;
  return part;
}

Json names_of(const std::vector<Effect>& effects) {
  Json names = Json::array();
  for (const Effect effect : effects) names.push_back(name_of(effect));
  return names;
}

Json request_part(const Request& request) {
  Json part;
  part["max_edge_m"] = json_of(request.max_edge);
  part["patches"] = json_of(request.patches);
  part["sides"] = name_of(request.sides);
  part["solver"] = name_of(request.solver);
  part["relaxation"] = json_of(request.relaxation);
  part["tolerance"] = request.tolerance.value_or(default_tolerance);
  part["max_iterations"] = request.max_iterations;
  part["max_rows"] = json_of(request.max_rows);
  part["samples"] = request.samples;
  part["estimator"] = name_of(request.estimator);
  part["close"] = request.close;
  part["on_demand"] = request.storage == Storage::on_demand;
  part["seed"] = request.seed;
  part["threads"] = request.threads;
  part["memory_bytes"] = json_of(request.memory);
  part["error_bars"] = request.error_bars;
  part["accuracy"] = json_of(request.accuracy);
  part["time_s"] = json_of(request.seconds);
  part["interest"] = request.interest;
  part["force"] = names_of(request.force);
  part["skip"] = names_of(request.skip);
  return part;
}

Json unanimous_part(const SamplingError::Unanimous& unanimous) {
  return {{"sampled_again", unanimous.pairs()}, {"missed", unanimous.missed}, {"bound", bound_on_miss(unanimous)}};
}

// As shares of the unoccluded exchange area; null where no pair was sampled again, as when rays decide none.
Json sampling_error_part(const SamplingError& error) {
  if (!was_audited(error)) return nullptr;
  Json part;
  part["by_visible_share"] = Json::array();
  for (std::size_t bin = 0; bin < SamplingError::bins; ++bin) {
    const double share = (static_cast<double>(bin) + 0.5) / SamplingError::bins;
    part["by_visible_share"].push_back({{"visible_share", share},
                                        {"sampled_again", with_visible_share(error, bin).pairs},
                                        {"standard_error", standard_error(error, share)}});
  }
  part["rays_all_free"] = unanimous_part(error.visible);
  part["rays_all_blocked"] = unanimous_part(error.occluded);
  return part;
}

Json plan_part(const Plan& plan) {
  Json part;
  part["max_edge_m"] = plan.max_edge;
  part["samples"] = plan.samples;
  part["estimator"] = name_of(plan.estimator);
  part["close"] = plan.close;
  part["on_demand"] = plan.storage == Storage::on_demand;
  part["lost_share_rays"] = plan.lost_share_rays;
  part["seed"] = plan.seed;
  part["solver"] = name_of(plan.solver.solver);
  part["tolerance"] = plan.solver.relative_error;
  part["max_iterations"] = plan.solver.max_iterations;
  part["emit_from_back"] = plan.sides.emit_from_back;
  part["sides_notes"] = plan.sides.notes;
  part["notes"] = plan.notes;
  part["decisions"] = decisions_part(plan.decisions);
  return part;
}

Json mesh_part(const Simulation& simulation) {
  Json part;
  part["patches"] = simulation.mesh.size();
  part["vertices"] = simulation.mesh.vertices.size();
  part["area_m2"] = simulation.problem.area.sum();
  return part;
}

using Bands = Eigen::Array<double, 1, Eigen::Dynamic>;

// What the patches of one material add up to, per band.
struct MaterialTotals {
  double area = 0;
  Bands emitted, absorbed, incident, lowest, highest;
};

std::vector<MaterialTotals> material_totals(const Simulation& simulation, std::size_t materials) {
  const Field& irradiance = simulation.solution.irradiance;
  const Bands zero = Bands::Zero(irradiance.cols());
  const Bands infinite = Bands::Constant(irradiance.cols(), std::numeric_limits<double>::infinity());
  std::vector<MaterialTotals> totals(materials, {0, zero, zero, zero, infinite, -infinite});
  for (PatchIndex i = 0; i < simulation.mesh.size(); ++i) {
    MaterialTotals& total = totals[simulation.mesh.material[i]];
    const double area = simulation.problem.area[i];
    total.area += area;
    total.emitted += area * simulation.problem.exitance.row(i);
    total.incident += area * irradiance.row(i);
    total.absorbed += area * (1 - simulation.problem.reflectance.row(i)) * irradiance.row(i);
    total.lowest = total.lowest.min(irradiance.row(i));
    total.highest = total.highest.max(irradiance.row(i));
  }
  return totals;
}

Json materials_part(const Scene& scene, const Simulation& simulation) {
  const std::vector<MaterialTotals> totals = material_totals(simulation, scene.materials.size());
  Json parts = Json::array();
  for (std::size_t m = 0; m < totals.size(); ++m) {
    const Material& material = scene.materials[m];
    const MaterialTotals& total = totals[m];
    Json part;
    part["name"] = material.name;
    part["area_m2"] = total.area;
    part["reflectance"] = json_array(material.reflectance);
    part["exitance_W_m2"] = json_array(material.exitance);
    part["flux_emitted_W"] = json_array(total.emitted);
    part["flux_absorbed_W"] = json_array(total.absorbed);
    // Without patches 0 / 0 and the infinities become null.
    part["irradiance_min_W_m2"] = json_array(total.lowest);
    part["irradiance_mean_W_m2"] = json_array(Bands(total.incident / total.area));
    part["irradiance_max_W_m2"] = json_array(total.highest);
    parts.push_back(std::move(part));
  }
  return parts;
}

// Row sums weighted by area; the defect is against what the lost shares leave, 1 - lost.
Json row_sum_part(const Eigen::VectorXd& row_sum, const Simulation& simulation) {
  if (row_sum.size() == 0) return {};
  const Eigen::ArrayXd& area = simulation.problem.area.array();
  const Eigen::ArrayXd defect = (row_sum - expected_row_sum(simulation.transport.lost)).array();
  Json part;
  part["min"] = row_sum.minCoeff();
  part["mean"] = (area * row_sum.array()).sum() / area.sum();
  part["max"] = row_sum.maxCoeff();
  part["rms_defect"] = std::sqrt((area * defect.square()).sum() / area.sum());
  return part;
}

// The patches whose form factors, before closure, are farthest off.
Json worst_rows_part(const Scene& scene, const Simulation& simulation) {
  constexpr std::size_t count = 5;
  const PatchMesh& mesh = simulation.mesh;
  Json part = Json::array();
  for (const RowDefect& row :
       worst_rows(simulation.transport.raw_row_sum, simulation.transport.lost, simulation.problem.area, count)) {
    const Polygon& polygon = scene.polygons[mesh.polygon[row.patch]];
    part.push_back({{"patch", row.patch},
                    {"place", place_of(scene, polygon)},
                    {"source_polygon", polygon.face},
                    {"group", group_name(scene, polygon.group)},
                    {"material", scene.materials[mesh.material[row.patch]].name},
                    {"centre_m", json_array(mesh.centroid[row.patch])},
                    {"area_m2", simulation.problem.area[row.patch]},
                    {"raw_row_sum", row.row_sum},
                    {"expected", row.expected}});
  }
  return part;
}

Json transport_part(const Scene& scene, const Simulation& simulation) {
  const TransportFacts& transport = simulation.transport;
  const Eigen::VectorXd& area = simulation.problem.area;
  Json part;
  // Pairs that are looked at on demand are not counted.
  const auto counted = [&](const auto& count) { return keeps_entries(simulation.plan.storage) ? Json(count) : Json(); };
  part["facing_pairs"] = counted(transport.counts.facing_pairs);
  part["near_pairs"] = counted(transport.counts.near_pairs);
  part["partly_occluded_pairs"] = counted(transport.counts.partial_pairs);
  part["blocked_pairs"] = counted(transport.counts.blocked_pairs);
  part["shadow_rays"] = counted(transport.counts.shadow_rays);
  part["bare_shadow_rays_per_second"] = counted(transport.bare_rays_per_second);
  part["hidden_pairs"] = counted(transport.counts.hidden_pairs);
  part["free_pairs"] = counted(transport.counts.free_pairs);
  part["sampling_error"] = sampling_error_part(transport.error);
  part["lost_share_rays"] =
      static_cast<std::uint64_t>(transport.lost.rays_per_patch) * static_cast<std::uint64_t>(simulation.mesh.size());
  part["closure"] = transport.closure;
  part["raw_row_sum"] = row_sum_part(transport.raw_row_sum, simulation);
  part["row_sum"] = row_sum_part(transport.row_sum, simulation);
  part["worst_rows"] = worst_rows_part(scene, simulation);
  part["lost_share"] = {{"escaped", area.dot(transport.lost.escaped) / area.sum()},
                        {"at_backs", area.dot(transport.lost.at_backs) / area.sum()}};
  return part;
}

// The defect is the row sums' and not known without them.
Json energy_part(const EnergyBalance& balance, bool row_sums_known) {
  Json part;
  part["emitted_W"] = json_array(balance.emitted);
  part["arriving_W"] = json_array(balance.arriving);
  part["absorbed_W"] = json_array(balance.absorbed);
  part["escaped_W"] = json_array(balance.escaped);
  part["lost_at_backs_W"] = json_array(balance.lost_at_backs);
  part["defect_W"] = row_sums_known ? json_array(balance.defect) : Json();
  part["imbalance"] = balance.imbalance;
  return part;
}

Json solution_part(const Simulation& simulation) {
  Json part;
  part["solver"] = name_of(simulation.plan.solver.solver);
  part["converged"] = simulation.solution.converged;
  part["singular"] = simulation.solution.trapped.empty() ? Json() : Json(simulation.solution.trapped);
  part["patch_bound"] = simulation.solution.patch_bound;
  part["iterations"] = Json::array();
  for (const Iteration& iteration : simulation.solution.history) {
    part["iterations"].push_back({{"number", iteration.number},
                                  {"relative_residual", iteration.relative_residual},
                                  {"error_bound", iteration.error_bound},
                                  {"seconds", iteration.seconds},
                                  {"work", iteration.work}});
  }
  return part;
}

Json costs_part(const std::vector<StageCost>& costs) {
  Json part = Json::array();
  for (const StageCost& cost : costs) {
    part.push_back({{"stage", name_of(cost.stage)}, {"seconds", cost.seconds}, {"cpu_seconds", cost.cpu_seconds}});
  }
  return part;
}

std::uint64_t memory_peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

}  // namespace

void write_report(const std::filesystem::path& file, const Run& run) {
  const Simulation& simulation = run.simulation;
  Json report;
  report["version"] = version();
  report["command_line"] = run.provenance.command_line;
  report["input"] = input_part(run.scene);
  report["request"] = request_part(run.request);
  report["plan"] = plan_part(simulation.plan);
  report["mesh"] = mesh_part(simulation);
  report["materials"] = materials_part(run.scene, simulation);
  if (!run.sensors.groups.empty()) report["sensors"] = sensors_part(run.sensors);
  report["transport"] = transport_part(run.scene, simulation);
  report["energy_balance"] = energy_part(simulation.balance, simulation.transport.row_sum.size() > 0);
  report["solution"] = solution_part(simulation);
  report["relative_error"] = relative_errors(simulation);
  report["relative_error_by_space"] = relative_errors_by_space(simulation);
  report["accuracy"] = accuracy_steps(simulation);
  report["costs"] = costs_part(simulation.costs);
  report["memory_peak_bytes"] = memory_peak_bytes();
  report["exposure"] = run.provenance.exposure;
  // Names from a model may hold bytes that are not UTF-8: they are replaced.
  write_bytes(file, report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace patchlight
