#include "archive/scene_file.h"

#include "patchlight/base/error.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/output/provenance.h"

#include "archive/file_names.h"
#include "archive/json_values.h"
#include "archive/lights_json.h"
#include "files/reason.h"
#include "files/regular_file.h"
#include "output/file/write_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace patchlight {
namespace {

// The bands of a scene, one entry per band.
nlohmann::ordered_json json_of_bands(const Bands& bands) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Band& band : bands)
    list.push_back({{"name", band.name},
                    {"luminous_weight", band.luminous_weight},
                    {"rgb", band.rgb},
                    {"edges_nm", band.edges_nm}});
  return list;
}

// Reads the bands back. Throws the exceptions of nlohmann::json if a part is missing or has another shape.
Bands bands_from(const nlohmann::ordered_json& json) {
  Bands bands;
  for (const auto& entry : json) {
    bands.push_back({entry.at("name").get<std::string>(), entry.at("luminous_weight").get<double>(),
                     entry.at("rgb").get<std::array<double, 3>>(), entry.value("edges_nm", std::array<double, 2>{})});
  }
  return bands;
}

using Indices = std::vector<std::uint32_t>;

constexpr const char* kind = "patchlight scene";

Json materials_part(const Scene& scene) {
  Json part = Json::array();
  for (const Material& material : scene.materials) {
    part.push_back({{"name", json_of(material.name)},
                    {"reflectance", json_of(material.reflectance)},
                    {"exitance", json_of(material.exitance)},
                    {"transmittance", json_of(material.transmittance)},
                    {"index", material.index},
                    {"specular_reflectance", json_of(material.specular_reflectance)},
                    {"diffuse_transmittance", json_of(material.diffuse_transmittance)},
                    {"second_face", material.second_face}});
  }
  return part;
}

Json lamp_hints_part(const Scene& scene) {
  Json part = Json::array();
  for (const LampHint& hint : scene.lamp_hints) {
    part.push_back(
        {{"material", json_of(hint.material)}, {"radiance", json_of(hint.radiance)}, {"reason", json_of(hint.reason)}});
  }
  return part;
}

Json vertices_part(const Scene& scene) {
  std::vector<double> coordinates;
  for (const Point& vertex : scene.vertices) coordinates.insert(coordinates.end(), vertex.begin(), vertex.end());
  return coordinates;
}

// One array per property, with an entry for each polygon; their corners one after the other.
Json polygons_part(const Scene& scene) {
  Indices corners, corner_counts, material, group, line, file, face;
  Json back_material = Json::array();
  for (const Polygon& polygon : scene.polygons) {
    corners.insert(corners.end(), polygon.corners.begin(), polygon.corners.end());
    corner_counts.push_back(static_cast<std::uint32_t>(polygon.corners.size()));
    material.push_back(polygon.material);
    back_material.push_back(polygon.back_material ? Json(*polygon.back_material) : Json());
    group.push_back(polygon.group);
    line.push_back(polygon.line);
    file.push_back(polygon.file);
    face.push_back(polygon.face);
  }
  return {{"corners", corners},
          {"corner_counts", corner_counts},
          {"material", material},
          {"group", group},
          {"back_material", back_material},
          {"line", line},
          {"file", file},
          {"face", face}};
}

// Without the faces.
Json diagnostics_part(const Diagnostics& diagnostics) {
  Json part = Json::array();
  for (const Diagnostic& found : diagnostics)
    part.push_back({{"code", name_of(found.code)},
                    {"count", found.count},
                    {"text", json_of(found.text)},
                    {"area_m2", found.area}});
  return part;
}

Diagnostics diagnostics_of(const Json& json) {
  Diagnostics diagnostics;
  for (const Json& part : json) {
    const std::string name = text_of(part.at("code"));
    const std::optional<DiagnosticCode> known = diagnostic_code(name);
    require(known.has_value(), "the code '" + name + "' is not known");
    diagnostics.push_back(
        {*known, text_of(part.at("text")), part.at("count").get<std::size_t>(), {}, part.at("area_m2").get<double>()});
  }
  return diagnostics;
}

Json sides_part(const KeptSides& sides) {
  return {{"front", sides.front},
          {"back", sides.back},
          {"emit_from_back", sides.emit_from_back},
          {"notes", diagnostics_part(sides.notes)}};
}

// `count` whole numbers from 0 up to, but without, `end`.
Indices indices_of(const Json& json, std::size_t count, std::uint64_t end = std::uint64_t{1} << 32) {
  require(json.is_array() && json.size() == count,
          "an array has " + std::to_string(json.size()) + " entries; expected " + std::to_string(count));
  Indices indices;
  for (const Json& entry : json) {
    require(entry.is_number_unsigned() && entry.get<std::uint64_t>() < end,
            "found " + entry.dump() + "; expected a whole number below " + std::to_string(end));
    indices.push_back(entry.get<std::uint32_t>());
  }
  return indices;
}

std::vector<Material> materials_of(const Json& json) {
  std::vector<Material> materials;
  for (const Json& entry : json) {
    Material material{text_of(entry.at("name")), spectrum_of(entry.at("reflectance")),
                      spectrum_of(entry.at("exitance")), spectrum_of(entry.at("transmittance")),
                      entry.value("index", usual_index)};
    if (entry.contains("specular_reflectance"))
      material.specular_reflectance = spectrum_of(entry.at("specular_reflectance"));
    if (entry.contains("diffuse_transmittance"))
      material.diffuse_transmittance = spectrum_of(entry.at("diffuse_transmittance"));
    material.second_face = entry.value("second_face", false);
    const Eigen::Index bands = materials.empty() ? material.reflectance.size() : materials[0].reflectance.size();
    const auto none_or_all = [bands](const Spectrum& spectrum) {
      return spectrum.size() == 0 || spectrum.size() == bands;
    };
    require(bands > 0 && material.reflectance.size() == bands && material.exitance.size() == bands &&
                none_or_all(material.transmittance) && none_or_all(material.specular_reflectance) &&
                none_or_all(material.diffuse_transmittance),
            "the materials do not all have the same bands");
    materials.push_back(std::move(material));
  }
  return materials;
}

std::vector<LampHint> lamp_hints_of(const Json& json) {
  std::vector<LampHint> hints;
  for (const Json& entry : json) {
    hints.push_back({text_of(entry.at("material")), spectrum_of(entry.at("radiance")), text_of(entry.at("reason"))});
  }
  return hints;
}

std::vector<Point> vertices_of(const Json& json) {
  const auto coordinates = json.get<std::vector<double>>();
  require(coordinates.size() % 3 == 0,
          "found " + std::to_string(coordinates.size()) + " coordinates; expected triples");
  std::vector<Point> vertices;
  for (std::size_t k = 0; k < coordinates.size(); k += 3) vertices.emplace_back(&coordinates[k]);
  return vertices;
}

std::vector<std::optional<MaterialIndex>> back_materials_of(const Json& json, std::size_t count, std::size_t end) {
  std::vector<std::optional<MaterialIndex>> materials;
  for (const Json& entry : json) {
    materials.push_back(entry.is_null() ? std::nullopt : std::optional(indices_of(Json::array({entry}), 1, end)[0]));
  }
  require(materials.size() == count, "found " + std::to_string(materials.size()) + " materials of backs");
  return materials;
}

std::vector<Polygon> polygons_of(const Json& json, std::size_t materials) {
  const std::size_t count = json.at("material").size();
  const Indices corner_counts = indices_of(json.at("corner_counts"), count);
  const Indices corners =
      indices_of(json.at("corners"), std::accumulate(corner_counts.begin(), corner_counts.end(), std::size_t{0}));
  const Indices material = indices_of(json.at("material"), count, materials);
  const auto back_material = back_materials_of(json.at("back_material"), count, materials);
  const Indices group = indices_of(json.at("group"), count);
  const Indices line = indices_of(json.at("line"), count);
  const Indices file = indices_of(json.at("file"), count);
  const Indices face = indices_of(json.at("face"), count);
  std::vector<Polygon> polygons;
  auto corner = corners.begin();
  for (std::size_t p = 0; p < count; ++p) {
    const auto end = corner + corner_counts[p];
    polygons.push_back({{corner, end}, material[p], group[p], line[p], file[p], face[p], back_material[p]});
    corner = end;
  }
  return polygons;
}

KeptSides sides_of(const Json& json, std::size_t polygons) {
  const Indices front = indices_of(json.at("front"), polygons, 2);
  const Indices back = indices_of(json.at("back"), polygons, 2);
  return {{front.begin(), front.end()},
          {back.begin(), back.end()},
          json.at("emit_from_back").get<bool>(),
          diagnostics_of(json.at("notes"))};
}

[[noreturn]] void refuse_lights(const std::filesystem::path& folder) {
  throw InputError(
      folder.string(),
      "its scene has luminaires, sun or sky, which earlier versions did not keep with form factors; compute "
      "them again: patchlight form-factors MODEL -o FOLDER");
}

StoredScene stored_scene_of(const Json& json) {
  require(json.at("kind") == kind, "its kind is " + json.at("kind").dump());
  Scene scene;
  scene.file = text_of(json.at("model"));
  scene.files = texts_of(json.at("files"));
  scene.sha256 = text_of(json.at("sha256"));
  scene.metres_per_unit = json.at("metres_per_unit").get<double>();
  scene.up = vector_of(json.at("up"));
  scene.up_stated = json.at("up_stated").get<bool>();
  scene.diagnostics = diagnostics_of(json.at("diagnostics"));
  scene.materials = materials_of(json.at("materials"));
  if (json.contains("bands")) scene.bands = bands_from(json.at("bands"));
  scene.lamp_hints = lamp_hints_of(json.at("lamp_hints"));
  scene.groups = texts_of(json.at("groups"));
  scene.vertices = vertices_of(json.at("vertices"));
  scene.polygons = polygons_of(json.at("polygons"), scene.materials.size());
  require(scene.metres_per_unit > 0 && std::isfinite(scene.metres_per_unit), "the unit has no length");
  require(scene.up.allFinite() && scene.up.norm() > 0, "no direction is up");
  if (json.contains("lights"))
    scene = with_views_of(with_lights_of(std::move(scene), json.at("lights")), json.at("views"));
  check(scene);
  KeptSides sides = sides_of(json.at("kept_sides"), scene.polygons.size());
  return {std::move(scene), std::move(sides)};
}

}  // namespace

void write_stored_scene(const std::filesystem::path& file, const Scene& scene, const KeptSides& sides) {
  Json json;
  json["kind"] = kind;
  json["version"] = version();
  json["model"] = json_of(scene.file);
  json["files"] = json_of(scene.files);
  json["sha256"] = json_of(scene.sha256);
  json["metres_per_unit"] = scene.metres_per_unit;
  json["up"] = json_of(scene.up);
  json["up_stated"] = scene.up_stated;
  Diagnostics diagnostics = scene.diagnostics;
  if (std::any_of(scene.materials.begin(), scene.materials.end(), [](const Material& m) { return m.texture; }))
    diagnostics.push_back({DiagnosticCode::simplified_picture, "pictures are not stored: their means count"});
  json["diagnostics"] = diagnostics_part(diagnostics);
  json["materials"] = materials_part(scene);
  if (!scene.bands.empty()) json["bands"] = json_of_bands(scene.bands);
  json["lamp_hints"] = lamp_hints_part(scene);
  json["lights"] = lights_part(scene);
  json["views"] = views_part(scene);
  json["groups"] = json_of(scene.groups);
  json["vertices"] = vertices_part(scene);
  json["polygons"] = polygons_part(scene);
  json["kept_sides"] = sides_part(sides);
  write_bytes(file, json.dump() + "\n");
}

StoredScene read_stored_scene(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / file_name::scene;
  require_regular_file(file);
  std::ifstream stream(file);
  if (!stream) {
    throw InputError(folder.string(), std::string("there is no ") + file_name::scene +
                                          " in it, as form factors of earlier versions have none; compute them again: "
                                          "patchlight form-factors MODEL -o FOLDER");
  }
  StoredScene stored;
  bool lights_left_out = false;
  try {
    const Json json = Json::parse(stream);
    lights_left_out = !json.contains("lights") && json.at("has_point_or_daylight").get<bool>();
    stored = stored_scene_of(json);
  } catch (const std::exception& error) {
    throw InputError(file.string(), "is not as patchlight form-factors writes it (" + reason_of(error) +
                                        "); compute the form factors again");
  }
  if (lights_left_out) refuse_lights(folder);
  return stored;
}

}  // namespace patchlight
