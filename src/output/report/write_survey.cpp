#include "output/report/write_survey.h"

#include "patchlight/output/provenance.h"

#include "output/file/whole_file.h"
#include "output/report/report_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace patchlight {

std::string plan_json(const Scene& scene, const Plan& plan, const ExpectedCost& cost) {
  nlohmann::ordered_json json;
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
  // Names from a model may hold bytes that are not UTF-8: they are replaced.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_plan(const std::filesystem::path& file, const Scene& scene, const Plan& plan, const ExpectedCost& cost) {
  write_bytes(file, plan_json(scene, plan, cost));
}

namespace {

// Keeps the keys in the order in which they are set.
using Json = nlohmann::ordered_json;

constexpr std::size_t most_faces = 1000;

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
  for (std::size_t k = 0; k < std::min(most_faces, problem.faces.size()); ++k) {
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

}  // namespace

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
  json["sun"] = sun_part(scene);
  json["sky"] = sky_part(scene);
  json["problems"] = Json::array();
  for (const Diagnostic& found : report.diagnostics)
    if (!is_note(found.code)) json["problems"].push_back(problem_part(scene, found));
  json["notes"] = json_of(chosen(report.diagnostics, is_note));
  // Names from a model may hold bytes that are not UTF-8: they are replaced.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_survey(const std::filesystem::path& file, const Scene& scene, const SceneReport& report) {
  write_bytes(file, survey_json(scene, report));
}

}  // namespace patchlight
