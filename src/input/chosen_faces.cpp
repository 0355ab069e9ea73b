#include "input/chosen_faces.h"

#include "patchlight/base/error.h"

#include "base/near_match.h"
#include "base/rounded.h"
#include "input/material_settings.h"
#include "input/materials.h"
#include "input/text.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace patchlight {
namespace {

// Newell's: the scene is not repaired yet.
double area_of(const Scene& scene, PolygonIndex polygon) {
  const std::vector<Point> points = corner_points(scene, polygon);
  Vector twice = Vector::Zero();
  for (std::size_t k = 0; k < points.size(); ++k)
    twice += (points[k] - points[0]).cross(points[(k + 1) % points.size()] - points[0]);
  return twice.norm() / 2;
}

[[noreturn]] void refuse_pattern(const Scene& scene, const std::string& pattern, const std::string& where) {
  std::set<std::string> names;
  for (std::uint32_t group = 0; group < scene.groups.size(); ++group) names.insert(group_name(scene, group));
  for (const Material& material : scene.materials) names.insert(material.name);
  const std::vector<std::string> allowed(names.begin(), names.end());
  const std::string hint = suggestion(pattern, allowed);
  throw InputError(where, "no face is of an object, group or material '" + pattern + "'" +
                              (hint.empty() ? "; patchlight check --all lists the names" : hint));
}

// For each group and each material whether a pattern means it; the second of a pair. \throws InputError when none is.
struct Meant {
  std::vector<bool> groups;
  std::vector<bool> materials;
  bool operator()(const Polygon& polygon) const { return groups[polygon.group] || materials[polygon.material]; }
};

Meant meant(const Scene& scene, const std::vector<std::string>& patterns, const std::string& where) {
  Meant all{std::vector<bool>(scene.groups.size()), std::vector<bool>(scene.materials.size())};
  for (const std::string& pattern : patterns) {
    const auto is_meant = [&](const std::string& name) { return name == pattern || matches(name, pattern); };
    bool found = false;
    for (std::uint32_t group = 0; group < scene.groups.size(); ++group) {
      if (!is_meant(group_name(scene, group))) continue;
      all.groups[group] = found = true;
    }
    for (std::size_t material = 0; material < scene.materials.size(); ++material) {
      if (!is_meant(scene.materials[material].name)) continue;
      all.materials[material] = found = true;
    }
    if (!found) refuse_pattern(scene, pattern, where);
  }
  return all;
}

std::string note_on_rest(const Scene& scene, const std::vector<bool>& stays) {
  std::set<std::uint32_t> groups;
  std::size_t faces = 0;
  double area = 0, all = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const double own = area_of(scene, p);
    all += own;
    if (stays[p]) continue;
    area += own;
    ++faces;
    groups.insert(scene.polygons[p].group);
  }
  return std::to_string(faces) + (faces == 1 ? " face of " : " faces of ") + std::to_string(groups.size()) +
         (groups.size() == 1 ? " object, " : " objects, ") + rounded(100 * area / all, 2) +
         " % of the area, do not take part, as asked";
}

}  // namespace

Scene with_chosen_faces(Scene scene, const FaceChoice& choice, const std::string& where) {
  if (choice.only.empty() && choice.leave_out.empty()) return scene;
  const Meant only = meant(scene, choice.only, where + ".only");
  const Meant leave_out = meant(scene, choice.leave_out, where + ".leave_out");
  std::vector<bool> stays;
  for (const Polygon& polygon : scene.polygons)
    stays.push_back((choice.only.empty() || only(polygon)) && !leave_out(polygon));
  if (std::find(stays.begin(), stays.end(), true) == stays.end())
    throw InputError(where + (choice.leave_out.empty() ? ".only" : ".leave_out"),
                     "found no face that stays; expected one at least");
  if (std::find(stays.begin(), stays.end(), false) == stays.end()) return scene;
  scene.diagnostics.push_back({DiagnosticCode::reduced_model, note_on_rest(scene, stays)});
  std::vector<Polygon> polygons;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (stays[p]) polygons.push_back(std::move(scene.polygons[p]));
  }
  scene.polygons = std::move(polygons);
  return with_used_materials(std::move(scene));
}

}  // namespace patchlight
