#include "plan/luminaire_problems.h"

#include "base/rounded.h"
#include "scene/box_row.h"
#include "scene/extent.h"
#include "scene/lamp_places.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

std::vector<Box> boxes_of_polygons(const Scene& scene) {
  std::vector<Box> boxes(scene.polygons.size());
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    for (const std::uint32_t corner : scene.polygons[p].corners) boxes[p].extend(scene.vertices[corner]);
  return boxes;
}

// How far from a point a polygon lies that comes nearer than a radius and lets no light through.
std::optional<double> near_distance(const Scene& scene, PolygonIndex polygon, const Point& middle, double radius) {
  const std::vector<Point> corners = corner_points(scene, polygon);
  if (is_opening(scene, polygon) || std::abs(front_normal(scene, polygon).dot(middle - corners[0])) >= radius)
    return {};
  double least = radius;
  for (const auto& [a, b, c] : triangulate(corners))
    least = std::min(least, distance_to({corners[a], corners[b], corners[c]}, middle));
  return least < radius ? std::optional(least) : std::nullopt;
}

// Farther off than masts are high, and than the model is long.
constexpr double farthest_luminaire = 30;  // metres

std::vector<Problem> problems_of_far_ones(const Scene& scene) {
  if (scene.luminaires.empty()) return {};
  const Box box = bounds(scene);
  const double length = box.diagonal().norm();
  double farthest = std::max(length, farthest_luminaire);
  std::vector<std::string> far;
  for (const Luminaire& luminaire : scene.luminaires) {
    const double distance = box.exteriorDistance(luminaire.position);
    if (distance <= std::max(length, farthest_luminaire)) continue;
    far.push_back("'" + luminaire.name + "' of " + luminaire.place);
    farthest = std::max(farthest, distance);
  }
  if (far.empty()) return {};
  const bool is_one = far.size() == 1;
  return {{ProblemKind::implausible_size,
           far.size(),
           (is_one ? "1 luminaire lies " : std::to_string(far.size()) + " luminaires lie up to ") + rounded(farthest) +
               " m from the model, which is " + rounded(length) + " m long (the first: " + far.front() + "). " +
               (is_one ? "Is its position in the unit of its file?" : "Are their positions in the unit of their file?"),
           {}}};
}

// Spheres that faces cut: what of their light starts behind the face falls on its other side.
std::vector<Problem> problems_of_cut_ones(const Scene& scene) {
  std::size_t count = 0;
  std::string first;
  std::optional<BoxRow> row;
  const double rounding = 1e-6 * extent_of(scene);  // a sphere that touches a face is not cut
  for (const Luminaire& luminaire : scene.luminaires) {
    const auto* const sphere = std::get_if<SphericalLamp>(&luminaire.light);
    if (sphere == nullptr) continue;
    if (!row) row.emplace(boxes_of_polygons(scene));
    const double radius = sphere->radius - rounding;
    const auto is_out = [&](const Box& box) { return box.exteriorDistance(luminaire.position) >= radius; };
    const auto is_cut = [&](std::size_t polygon) {
      return near_distance(scene, static_cast<PolygonIndex>(polygon), luminaire.position, radius).has_value();
    };
    const auto cut = row->first(0, is_out, is_cut);
    if (!cut || ++count > 1) continue;
    const Polygon& polygon = scene.polygons[*cut];
    const double distance =
        near_distance(scene, static_cast<PolygonIndex>(*cut), luminaire.position, radius).value_or(0);
    first = "'" + luminaire.name + "' (" + luminaire.place + "), of radius " + rounded(sphere->radius) +
            " m, whose middle is " + rounded(distance) + " m from face '" + group_name(scene, polygon.group) + "' (" +
            place_of(scene, polygon) + ")";
  }
  if (count == 0) return {};
  return {
      {ProblemKind::implausible_size,
       count,
       (count == 1 ? "1 sphere luminaire is" : std::to_string(count) + " sphere luminaires are") +
           " cut by faces (the first: " + first +
           "): light of the part behind the face falls on its other side. Move the luminaire away, or make it smaller",
       {}}};
}

}  // namespace

std::vector<Problem> problems_with_luminaires(const Scene& scene) {
  std::vector<Problem> problems = problems_of_far_ones(scene);
  for (Problem& problem : problems_of_cut_ones(scene)) problems.push_back(std::move(problem));
  return problems;
}

}  // namespace patchlight
