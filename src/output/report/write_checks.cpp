#include "output/report/write_checks.h"

#include "output/file/whole_file.h"
#include "output/report/report_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight {

using Json = nlohmann::ordered_json;

namespace {

// Spectra that are empty are null.
Json spectrum_part(const Spectrum& spectrum) { return spectrum.size() > 0 ? json_array(spectrum) : Json(); }

Json material_part(const MaterialFacts& facts) {
  const Material& material = facts.material;
  const bool is_pane = (material.transmittance > 0).any();
  const bool is_mirror = (material.specular_reflectance > 0).any();
  Json part;
  part["name"] = material.name;
  part["reflectance"] = json_array(material.reflectance);
  part["specular_reflectance"] = is_mirror ? spectrum_part(material.specular_reflectance) : Json();
  part["transmittance"] = is_pane ? spectrum_part(material.transmittance) : Json();
  part["index"] = is_pane ? Json(material.index) : Json();
  const bool is_translucent = (material.diffuse_transmittance > 0).any();
  part["diffuse_transmittance"] = is_translucent ? spectrum_part(material.diffuse_transmittance) : Json();
  part["exitance_W_m2"] = json_array(material.exitance);
  part["faces"] = facts.faces;
  part["area_m2"] = facts.area;
  part["flux_W"] = json_array(facts.flux);
  part["flux_lm"] = facts.luminous_flux;
  return part;
}

Json sun_part(const Scene& scene) {
  if (!scene.sun) return nullptr;
  Json part;
  part["direction"] = json_array(scene.sun->direction);
  part["normal_irradiance_W_m2"] = json_array(scene.sun->normal_irradiance);
  return part;
}

Json sky_part(const Scene& scene) {
  if (!scene.sky) return nullptr;
  Json part;
  part["kind"] = name_of(scene.sky->kind);
  part["horizontal_irradiance_W_m2"] = spectrum_part(scene.sky->horizontal_irradiance);
  part["zenith_radiance_W_m2_sr"] = spectrum_part(scene.sky->zenith_radiance);
  part["ground_radiance_W_m2_sr"] = spectrum_part(scene.sky->ground_radiance);
  return part;
}

Json problem_part(const Scene& scene, const Diagnostic& problem) {
  Json part;
  part["kind"] = name_of(problem.code);
  part["severity"] = name_of(severity_of(problem.code));
  part["count"] = problem.count;
  part["what"] = problem.text;
  part["faces"] = Json::array();
  for (std::size_t k = 0; k < std::min<std::size_t>(1000, problem.faces.size()); ++k) {
    const ModelFace& face = problem.faces[k];
    Json entry;
    entry["file"] = face.file < scene.files.size() ? scene.files[face.file] : scene.file;
    entry["line"] = face.line;
    part["faces"].push_back(entry);
  }
  return part;
}

Json sides_part(const SceneReport& report) {
  if (!report.sides) return nullptr;
  Json part;
  part["chosen"] = name_of(report.sides->chosen);
  part["take_part"] = report.sides->kept;
  part["of"] = 2 * report.polygons;
  part["area_m2"] = report.sides->area;
  part["notes"] = json_of(report.sides->notes);
  return part;
}

Json case_part(const ValidationResult& result) {
  Json part;
  part["case"] = result.name;
  part["exact"] = result.exact;
  part["exact_from"] = result.source;
  part["computed"] = result.measured.value;
  part["error_bar"] = result.measured.error_bar;
  part["error_bar_from"] = result.measured.bar_from;
  part["within_bar"] = within_bar(result);
  return part;
}

template <typename Values>
std::vector<double> list(const Values& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

std::vector<double> row(const Field& field, Eigen::Index i) { return list(Spectrum(field.row(i))); }

Json part_of(const VerifiedPart& part) {
  return {{"part", part.name},
          {"checked", part.rows.size()},
          {"dark", list(part.dark)},
          {"chi_square", list(part.chi_square)},
          {"mean_difference", list(part.mean_difference)},
          {"error", list(part.error)},
          {"noise", list(part.noise)},
          {"offset", list(part.offset)},
          {"width", part.width}};
}

// A row of a comparison with traced paths, in all bands.
Json compared_part(const SolvedAndTraced& compared, const Field& z, const Field& with_bar, Eigen::Index i) {
  return {{"irradiance_W_m2", row(compared.irradiance, i)},
          {"bar_W_m2", row(compared.bar, i)},
          {"traced_W_m2", row(compared.paths.irradiance, i)},
          {"standard_error_W_m2", row(compared.paths.standard_error, i)},
          {"z", row(z, i)},
          {"z_with_bar", row(with_bar, i)}};
}

Json checked_part(const Scene& scene, const PatchMesh& mesh, const Verification& verification) {
  Json part = Json::array();
  const Field z = deviations_by_noise(verification);
  const Field with_bar = deviations(verification);
  for (std::size_t k = 0; k < verification.patches.size(); ++k) {
    const PatchIndex patch = verification.patches[k];
    const Polygon& polygon = scene.polygons[mesh.polygon[patch]];
    part.push_back({{"patch", patch},
                    {"place", place_of(scene, polygon)},
                    {"source_polygon", polygon.face},
                    {"group", group_name(scene, polygon.group)},
                    {"material", scene.materials[mesh.material[patch]].name},
                    {"side", name_of(mesh.side[patch])},
                    {"centre_m", list(mesh.centroid[patch])},
                    {"area_m2", mesh.area[patch]}});
    part.back().update(compared_part(verification, z, with_bar, static_cast<Eigen::Index>(k)));
  }
  return part;
}

// Rooms or sensors.
Json family_of(const VerifiedFamily& family) {
  Json json = part_of(family.part);
  json["paths"] = family.compared.paths.paths;
  json["rows"] = Json::array();
  const Field z = deviations_by_noise(family.compared);
  const Field with_bar = deviations(family.compared);
  for (std::size_t k = 0; k < family.names.size(); ++k) {
    json["rows"].push_back({{"name", family.names[k]}});
    json["rows"].back().update(compared_part(family.compared, z, with_bar, static_cast<Eigen::Index>(k)));
  }
  return json;
}

Json left_out_part(const Scene& scene, const Verification& verification) {
  Json part = Json::array();
  for (const LeftOutSide& side : verification.left_out) {
    const Polygon& polygon = scene.polygons[side.polygon];
    part.push_back({{"place", place_of(scene, polygon)},
                    {"source_polygon", polygon.face},
                    {"side", name_of(side.side)},
                    {"traced_W_m2", list(side.irradiance)},
                    {"standard_error_W_m2", list(side.standard_error)},
                    {"lit", side.is_lit}});
  }
  return part;
}

}  // namespace

std::string plan_json(const Scene& scene, const Plan& plan, const ExpectedCost& cost) {
  Json json;
  json["version"] = version();
  json["file"] = scene.file;
  json["sha256"] = scene.sha256;
  json["polygons"] = scene.polygons.size();
  json["max_edge_m"] = plan.max_edge;
  json["storage"] = name_of(plan.assembly.storage);
  json["solver"] = name_of(plan.solver.solver);
  json["decisions"] = decisions_part(plan.decisions);
  json["expected"] = {{"patches", cost.patches},
                      {"memory_bytes", cost.bytes},
                      {"of_first_mesh", cost.of_first_mesh},
                      {"threads", cost.threads},
                      {"seconds", cost.seconds()},
                      {"form_factor_cpu_seconds", cost.form_factor_seconds},
                      {"direct_light_cpu_seconds", cost.direct_light_seconds},
                      {"solve_cpu_seconds", cost.solve_seconds},
                      {"sensors", cost.sensors},
                      {"sensor_cpu_seconds", cost.sensor_seconds}};
  json["sides_notes"] = json_of(plan.sides.notes);
  json["notes"] = json_of(plan.notes);
  json["scene_warnings"] = json_of(chosen(scene.diagnostics, makes_results_wrong));
  json["scene_notes"] = json_of(remarks_of(scene));
  return json_text(json);
}

std::string survey_json(const Scene& scene, const SceneReport& report) {
  Json json;
  json["version"] = version();
  json["file"] = scene.file;
  json["sha256"] = scene.sha256;
  json["usable"] = report.usable;
  json["metres_per_unit"] = scene.metres_per_unit;
  json["bounds_m"] = {json_array(report.bounds.min()), json_array(report.bounds.max())};
  json["size_m"] = json_array(Vector(report.bounds.sizes()));
  json["unit_guess"] = report.unit_guess ? Json(report.unit_guess->unit) : Json();
  json["polygons"] = report.polygons;
  json["vertices"] = report.vertices;
  json["groups"] = report.groups;
  json["area_m2"] = report.area;
  json["lamps"] = report.lamps;
  json["shells"] = report.shells;
  json["closed_shells"] = report.closed_shells;
  json["open_edges"] = report.open_edges;
  json["open_edge_length_m"] = report.open_edge_length;
  json["sides"] = sides_part(report);
  json["objects"] = Json::array();
  for (const ObjectFacts& facts : report.objects)
    json["objects"].push_back({{"name", facts.name}, {"faces", facts.faces}, {"area_m2", facts.area}});
  json["materials"] = Json::array();
  for (const MaterialFacts& facts : report.materials) json["materials"].push_back(material_part(facts));
  json["luminaires"] = luminaires_part(scene.luminaires);
  json["sun"] = sun_part(scene);
  json["sky"] = sky_part(scene);
  json["problems"] = Json::array();
  for (const Diagnostic& found : report.diagnostics)
    if (!is_note(found.code)) json["problems"].push_back(problem_part(scene, found));
  json["notes"] = json_of(chosen(report.diagnostics, is_note));
  return json_text(json);
}

std::string validation_json(std::span<const ValidationResult> results) {
  Json json;
  json["version"] = version();
  json["sound"] = std::all_of(results.begin(), results.end(), within_bar);
  json["cases"] = Json::array();
  for (const ValidationResult& result : results) json["cases"].push_back(case_part(result));
  return json_text(json);
}

void write_verification(const std::filesystem::path& file, const Scene& scene, const Simulation& simulation,
                        const Verification& verification, const Provenance& provenance) {
  Json json;
  json["version"] = version();
  json["command_line"] = provenance.command_line;
  json["input"] = {{"file", scene.file}, {"sha256", scene.sha256}};
  json["verdict"] = name_of(verification.verdict);
  json["agrees"] = verification.verdict == Verdict::agrees;
  json["probability"] = verification.probability;
  json["least_probability"] = least_probability;
  json["relative_error"] = relative_errors(simulation.accuracy);
  json["relative_error_by_space"] = relative_errors_by_space(simulation.spaces);
  json["widest_bar"] = widest_bar;
  json["parts"] = Json::array();
  for (const VerifiedPart& part : verification.parts) json["parts"].push_back(part_of(part));
  json["families"] = Json::array();
  for (const VerifiedFamily& family : verification.families) json["families"].push_back(family_of(family));
  json["patches"] = simulation.mesh.size();
  json["paths_per_patch"] = verification.paths.paths;
  json["first_paths_per_patch"] = verification.first_paths;
  json["rays"] = verification.paths.rays;
  json["checked"] = checked_part(scene, simulation.mesh, verification);
  json["left_out_sides"] = left_out_part(scene, verification);
  write_bytes(file, json_text(json));
}

}  // namespace patchlight
