#include "input/faces_of.h"

#include "patchlight/base/error.h"

#include "base/near_match.h"
#include "input/material_settings.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace patchlight {
namespace {

std::string file_of(const Scene& scene, const Polygon& polygon) {
  return polygon.file < scene.files.size() ? scene.files[polygon.file] : scene.file;
}

[[noreturn]] void refuse_faces(const Scene& scene, const std::string& pattern, const std::string& where) {
  std::set<std::string> names;
  for (std::uint32_t group = 0; group < scene.groups.size(); ++group) names.insert(group_name(scene, group));
  for (const std::string& file : scene.files) names.insert(std::filesystem::path(file).filename().string());
  const std::vector<std::string> allowed(names.begin(), names.end());
  const std::string hint = suggestion(pattern, allowed);
  throw InputError(where, "no face is of an object, group or file '" + pattern + "'" +
                              (hint.empty() ? "; patchlight check --all lists the names" : hint));
}

}  // namespace

std::vector<bool> faces_of(const Scene& scene, const std::string& pattern, const std::string& where) {
  const auto is_meant = [&pattern](const std::string& name) { return name == pattern || matches(name, pattern); };
  std::vector<bool> groups;
  for (std::uint32_t group = 0; group < scene.groups.size(); ++group)
    groups.push_back(is_meant(group_name(scene, group)));
  std::vector<bool> faces;
  for (const Polygon& polygon : scene.polygons) {
    const std::string file = file_of(scene, polygon);
    const bool by_group = polygon.group < groups.size() && groups[polygon.group];
    faces.push_back(by_group || file == pattern || is_meant(std::filesystem::path(file).filename().string()));
  }
  if (std::find(faces.begin(), faces.end(), true) == faces.end()) refuse_faces(scene, pattern, where);
  return faces;
}

std::vector<std::size_t> materials_of(const Scene& scene, const std::vector<bool>& polygons) {
  std::set<std::size_t> materials;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!polygons[p]) continue;
    materials.insert(scene.polygons[p].material);
    if (scene.polygons[p].back_material) materials.insert(*scene.polygons[p].back_material);
  }
  return {materials.begin(), materials.end()};
}

OwnMaterials with_own_materials(Scene scene, const std::vector<bool>& polygons, std::vector<std::size_t> materials,
                                const std::string& of) {
  std::vector<bool> others = polygons;
  others.flip();
  const std::vector<std::size_t> shared = materials_of(scene, others);
  for (std::size_t& material : materials) {
    if (!std::binary_search(shared.begin(), shared.end(), material)) continue;
    const auto copy = static_cast<MaterialIndex>(scene.materials.size());
    scene.materials.push_back(scene.materials[material]);
    scene.materials.back().name += " of " + of;
    for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
      Polygon& polygon = scene.polygons[p];
      if (!polygons[p]) continue;
      if (polygon.material == material) polygon.material = copy;
      if (polygon.back_material == material) polygon.back_material = copy;
    }
    material = copy;
  }
  return {std::move(scene), std::move(materials)};
}

}  // namespace patchlight
