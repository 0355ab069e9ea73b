#include "output/report/write_verification.h"

#include "patchlight/output/provenance.h"

#include "output/file/whole_file.h"
#include "output/report/report_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

namespace patchlight {
namespace {

// Keeps the keys in the order in which they are set.
using Json = nlohmann::ordered_json;

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

}  // namespace

std::string validation_json(std::span<const ValidationResult> results) {
  Json json;
  json["version"] = version();
  json["sound"] = std::all_of(results.begin(), results.end(), within_bar);
  json["cases"] = Json::array();
  for (const ValidationResult& result : results) json["cases"].push_back(case_part(result));
  return json.dump(2) + "\n";
}

void write_validation(const std::filesystem::path& file, std::span<const ValidationResult> results) {
  write_bytes(file, validation_json(results));
}

namespace {

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

Json checked_part(const Scene& scene, const PatchMesh& mesh, const Verification& verification) {
  Json part = Json::array();
  const Field z = deviations_by_noise(verification);
  const Field with_bar = deviations(verification);
  for (std::size_t k = 0; k < verification.patches.size(); ++k) {
    const PatchIndex patch = verification.patches[k];
    const Polygon& polygon = scene.polygons[mesh.polygon[patch]];
    const auto i = static_cast<Eigen::Index>(k);
    part.push_back({{"patch", patch},
                    {"place", place_of(scene, polygon)},
                    {"source_polygon", polygon.face},
                    {"group", group_name(scene, polygon.group)},
                    {"material", scene.materials[mesh.material[patch]].name},
                    {"side", name_of(mesh.side[patch])},
                    {"centre_m", list(mesh.centroid[patch])},
                    {"area_m2", mesh.area[patch]},
                    {"irradiance_W_m2", row(verification.irradiance, i)},
                    {"bar_W_m2", row(verification.bar, i)},
                    {"traced_W_m2", row(verification.paths.irradiance, i)},
                    {"standard_error_W_m2", row(verification.paths.standard_error, i)},
                    {"z", row(z, i)},
                    {"z_with_bar", row(with_bar, i)}});
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
    const auto i = static_cast<Eigen::Index>(k);
    json["rows"].push_back({{"name", family.names[k]},
                            {"irradiance_W_m2", row(family.compared.irradiance, i)},
                            {"bar_W_m2", row(family.compared.bar, i)},
                            {"traced_W_m2", row(family.compared.paths.irradiance, i)},
                            {"standard_error_W_m2", row(family.compared.paths.standard_error, i)},
                            {"z", row(z, i)},
                            {"z_with_bar", row(with_bar, i)}});
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
  write_bytes(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace patchlight
