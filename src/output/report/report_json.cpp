#include "output/report/report_json.h"

#include "light/photometry.h"
#include "output/file/whole_file.h"
#include "scene/luminaire_kinds.h"
#include "scene/photometric_web.h"

#include <sys/resource.h>

namespace patchlight {
namespace {

using Json = nlohmann::ordered_json;

Json errors_of(const AccuracyStep& step) {
  return {{"mesh", step.mesh},
          {"form_factor", step.form_factor},
          {"solver", step.solver},
          {"total", step.total},
          {"display", step.display}};
}

// Lists the refinements on the way to an accuracy: an entry for each mesh. Empty without error bars.
Json accuracy_steps(const std::vector<AccuracyStep>& steps) {
  Json parts = Json::array();
  for (const AccuracyStep& step : steps) {
    Json part = {{"patches", step.patches}, {"new_patches", step.new_patches}, {"samples", step.samples}};
    part.update(errors_of(step));
    part["seconds"] = step.seconds;
    part["cpu_seconds"] = step.cpu_seconds;
    parts.push_back(std::move(part));
  }
  return parts;
}

Json sensors_part(const SensorFacts& sensors) {
  Json part;
  part["unit"] = sensors.unit;
  part["groups"] = Json::array();
  for (const GroupReadings& group : sensors.groups) {
    Json entry;
    entry["name"] = group.name;
    entry["sensors"] = group.sensors;
    entry["inside_walls"] = group.inside_walls;
    entry["min"] = group.min;
    entry["mean"] = group.mean;
    entry["standard_error_of_mean"] = group.standard_error_of_mean;
    entry["max"] = group.max;
    entry["uniformity"] = group.uniformity;
    entry["largest_standard_error"] = group.largest_standard_error;
    if (group.mean_daylight_factor) entry["mean_daylight_factor_percent"] = *group.mean_daylight_factor;
    part["groups"].push_back(std::move(entry));
  }
  part["warnings"] = json_of(sensors.warnings);
  return part;
}

constexpr auto note_on_coarse =
    "min and uniformity of a coarse surface may be too high: its dark patches are larger than the cells of an EN "
    "12464-1 grid, or points of them are darker than their means. Sensors on a grid, which patchlight init writes for "
    "rooms, give the values of the standard. Smaller patches come closer to them.";

// The light on floor, walls and ceiling of each room.
Json rooms_part(const Report& report) {
  Json part;
  part["unit"] = report.unit;
  part["rooms"] = Json::array();
  for (const RoomLight& room : report.rooms) {
    Json entry;
    entry["name"] = room.name;
    for (const SurfaceLight& surface : room.surfaces) {
      if (surface.area == 0) continue;
      entry[name_of(surface.surface)] = {{"area_m2", surface.area},
                                         {"min", surface.min},
                                         {"mean", surface.mean},
                                         {"uniformity", surface.uniformity},
                                         {"coarse", surface.is_coarse}};
      if (surface.is_coarse) part["note"] = note_on_coarse;
    }
    part["rooms"].push_back(std::move(entry));
  }
  return part;
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(); }
Json json_of(const std::optional<std::size_t>& value) { return value ? Json(*value) : Json(); }

// Bands of wavelengths, and how colors follow from them.
Json bands_part(const Bands& bands) {
  Json edges = Json::array();
  for (const Band& band : bands) edges.push_back(band.edges_nm);
  return {
      {"edges_nm", std::move(edges)}, {"observer", "CIE 1931, 2 degrees"}, {"white_of_rgb", "D65, without adaptation"}};
}

Json scene_part(const SceneFacts& scene) {
  Json part;
  part["file"] = scene.file;
  part["sha256"] = scene.sha256;
  part["polygons"] = scene.polygons;
  part["materials"] = scene.materials;
  part["luminaires"] = luminaires_part(scene.luminaires);
  part["metres_per_unit"] = scene.metres_per_unit;
  part["up"] = json_array(scene.up);
  part["warnings"] = json_of(scene.warnings);
  part["notes"] = json_of(scene.notes);
  if (are_of_wavelengths(scene.bands)) part["bands"] = bands_part(scene.bands);
  return part;
}

Json names_of(const std::vector<Effect>& effects) {
  Json names = Json::array();
  for (const Effect effect : effects) names.push_back(name_of(effect));
  return names;
}

Json request_part(const Request& request) {
  Json part;
  part["max_edge_m"] = json_of(request.mesh.max_edge);
  part["patches"] = json_of(request.mesh.patches);
  part["sides"] = name_of(request.mesh.sides);
  part["contact_lines"] = request.mesh.contact_lines;
  part["graded_edges"] = request.mesh.graded_edges;
  part["solver"] = name_of(request.solver.solver);
  part["relaxation"] = json_of(request.solver.relaxation);
  part["tolerance"] = tolerance_of(request.solver);
  part["max_iterations"] = request.solver.max_iterations;
  part["max_rows"] = json_of(request.solver.max_rows);
  part["samples"] = request.assembly.samples;
  part["estimator"] = name_of(request.assembly.estimator);
  part["close"] = request.assembly.close;
  part["storage"] = name_of(request.assembly.storage);
  part["rays"] = request.assembly.rays;
  part["seed"] = request.assembly.seed;
  part["threads"] = request.resources.threads;
  part["memory_bytes"] = json_of(request.resources.memory);
  part["error_bars"] = request.accuracy.error_bars;
  part["local_cuts"] = request.accuracy.local_cuts;
  part["accuracy"] = json_of(request.accuracy.relative_error);
  part["time_s"] = json_of(request.accuracy.seconds);
  part["interest"] = request.accuracy.interest;
  part["force"] = names_of(request.effects.force);
  part["skip"] = names_of(request.effects.skip);
  return part;
}

Json plan_part(const Report& report) {
  const Plan& plan = report.plan;
  Json part;
  part["max_edge_m"] = plan.max_edge;
  part["contact_lines"] = number_of(plan.contacts);
  part["samples"] = plan.assembly.samples;
  part["estimator"] = name_of(plan.assembly.estimator);
  part["close"] = plan.assembly.close;
  part["storage"] = name_of(plan.assembly.storage);
  part["rays"] = plan.assembly.rays;
  part["lost_share_rays"] = plan.assembly.lost_share_rays;
  part["seed"] = plan.assembly.seed;
  part["solver"] = name_of(plan.solver.solver);
  part["tolerance"] = tolerance_of(plan.solver);
  part["max_iterations"] = plan.solver.max_iterations;
  part["emit_from_back"] = plan.sides.emit_from_back;
  part["sides_notes"] = json_of(plan.sides.notes);
  part["notes"] = json_of(report.notes);
  part["decisions"] = decisions_part(plan.decisions);
  return part;
}

Json mesh_part(const Report& report) {
  return {{"patches", report.patches}, {"vertices", report.vertices}, {"area_m2", report.area}};
}

// The color of the light that a material sends out, averaged over its area.
void add_colour(Json& part, const MaterialLight& material, const Bands& bands) {
  const Eigen::Vector3d xyz = xyz_of(material.radiance, bands);
  part["radiance_mean_W_m2_sr"] = json_array(material.radiance);
  part["xyz_mean_cd_m2"] = json_array(xyz);
  part["cct_K"] = json_of(correlated_colour_temperature(xyz));
}

Json materials_part(const std::vector<MaterialLight>& materials, const Bands& bands) {
  Json parts = Json::array();
  for (const MaterialLight& material : materials) {
    Json part;
    part["name"] = material.name;
    part["area_m2"] = material.area;
    part["reflectance"] = json_array(material.reflectance);
    part["exitance_W_m2"] = json_array(material.exitance);
    part["flux_emitted_W"] = json_array(material.emitted);
    part["flux_absorbed_W"] = json_array(material.absorbed);
    part["irradiance_min_W_m2"] = json_array(material.lowest);
    part["irradiance_mean_W_m2"] = json_array(material.mean);
    part["irradiance_max_W_m2"] = json_array(material.highest);
    if (are_of_wavelengths(bands)) add_colour(part, material, bands);
    parts.push_back(std::move(part));
  }
  return parts;
}

Json row_sum_part(const std::optional<RowSumFacts>& row_sum) {
  if (!row_sum) return nullptr;
  return {{"min", row_sum->min}, {"mean", row_sum->mean}, {"max", row_sum->max}, {"rms_defect", row_sum->rms_defect}};
}

Json worst_part(const std::vector<WorstPatch>& worst) {
  Json part = Json::array();
  for (const WorstPatch& patch : worst) {
    part.push_back({{"patch", patch.patch},
                    {"place", patch.place},
                    {"source_polygon", patch.face},
                    {"group", patch.group},
                    {"material", patch.material},
                    {"centre_m", json_array(patch.centre)},
                    {"area_m2", patch.area},
                    {"raw_row_sum", patch.row_sum},
                    {"expected", patch.expected}});
  }
  return part;
}

Json transport_part(const FormFactorFacts& facts) {
  Json part;
  // Pairs that are looked at on demand are not counted.
  const auto counted = [&](std::uint64_t AssemblyCounts::*count) {
    return facts.counts ? Json((*facts.counts).*count) : Json();
  };
  part["facing_pairs"] = counted(&AssemblyCounts::facing_pairs);
  part["near_pairs"] = counted(&AssemblyCounts::near_pairs);
  part["partly_occluded_pairs"] = counted(&AssemblyCounts::partial_pairs);
  part["blocked_pairs"] = counted(&AssemblyCounts::blocked_pairs);
  part["shadow_rays"] = counted(&AssemblyCounts::shadow_rays);
  part["bare_shadow_rays_per_second"] = facts.counts ? Json(facts.bare_rays_per_second) : Json();
  part["hidden_pairs"] = counted(&AssemblyCounts::hidden_pairs);
  part["free_pairs"] = counted(&AssemblyCounts::free_pairs);
  part["lost_share_rays"] = facts.lost_share_rays;
  part["ray_error"] = facts.ray_error ? Json(*facts.ray_error) : Json();
  part["closure"] = facts.closure;
  part["raw_row_sum"] = row_sum_part(facts.raw_row_sum);
  part["row_sum"] = row_sum_part(facts.row_sum);
  part["worst_rows"] = worst_part(facts.worst);
  part["lost_share"] = {{"escaped", facts.escaped}, {"at_backs", facts.at_backs}};
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

Json solution_part(const Report& report) {
  const SolutionFacts& solution = report.solution;
  Json part;
  part["solver"] = name_of(report.plan.solver.solver);
  part["converged"] = solution.converged;
  part["unfinished"] = solution.unfinished;
  part["singular"] = solution.trapped.empty() ? Json() : Json(solution.trapped);
  part["patch_bound"] = solution.patch_bound;
  part["iterations"] = Json::array();
  for (const Iteration& iteration : solution.history) {
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

std::string json_text(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

Json relative_errors(const std::vector<AccuracyStep>& steps) {
  if (steps.empty()) return nullptr;
  Json part = errors_of(steps.back());
  part["inside"] = steps.back().inside;
  return part;
}

Json relative_errors_by_space(const std::vector<SpaceErrors>& spaces) {
  if (spaces.empty()) return nullptr;
  Json part;
  for (const SpaceErrors& space : spaces) {
    part[space.space] = errors_of(space.errors);
    part[space.space]["patches"] = space.errors.patches;
  }
  return part;
}

Json decisions_part(const std::vector<Decision>& decisions) {
  Json part = Json::array();
  for (const Decision& decision : decisions) {
    part.push_back({{"effect", name_of(decision.effect)},
                    {"simulate", decision.simulate},
                    {"reason", decision.reason},
                    {"saving", decision.saving},
                    {"forced", decision.forced}});
  }
  return part;
}

Json luminaires_part(const std::vector<Luminaire>& luminaires) {
  Json parts = Json::array();
  for (const Luminaire& luminaire : luminaires) {
    const auto* const measured = std::get_if<WebLight>(&luminaire.light);
    parts.push_back({{"name", luminaire.name},
                     {"kind", kind_of(luminaire)},
                     {"file", measured != nullptr ? Json(measured->web->file) : Json()},
                     {"place", luminaire.place},
                     {"position_m", json_array(luminaire.position)},
                     {"aim", json_array(Vector(luminaire.aim.array() + 0.0))}});  // without a sign of 0
  }
  return parts;
}

Json report_json(const Report& report, const Provenance& provenance) {
  Json json;
  json["version"] = version();
  json["command_line"] = provenance.command_line;
  json["input"] = scene_part(report.scene);
  json["request"] = request_part(report.request);
  json["plan"] = plan_part(report);
  json["mesh"] = mesh_part(report);
  json["materials"] = materials_part(report.materials, report.scene.bands);
  json["room_surfaces"] = rooms_part(report);
  if (!report.sensors.groups.empty()) json["sensors"] = sensors_part(report.sensors);
  json["transport"] = transport_part(report.form_factors);
  json["energy_balance"] = energy_part(report.balance, report.form_factors.row_sum.has_value());
  json["solution"] = solution_part(report);
  json["relative_error"] = relative_errors(report.accuracy);
  json["relative_error_by_space"] = relative_errors_by_space(report.spaces);
  json["accuracy"] = accuracy_steps(report.accuracy);
  json["costs"] = costs_part(report.costs);
  json["memory_peak_bytes"] = memory_peak_bytes();
  json["exposure"] = provenance.exposure;
  return json;
}

void write_report(const std::filesystem::path& file, const Report& report, const Provenance& provenance) {
  write_bytes(file, json_text(report_json(report, provenance)));
}

}  // namespace patchlight
