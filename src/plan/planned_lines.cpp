#include "plan/planned_lines.h"

#include "mesh/mesher.h"
#include "plan/shadow_lines.h"
#include "scene/extent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

// To cut faces at more lines takes longer than light through them.
constexpr std::size_t most_lines = 20'000;

// Where there are so many times the patches that there are without lines faces cross anywhere.
bool are_too_many(std::size_t patches, std::size_t without_lines) {
  constexpr std::size_t many = 3;
  constexpr std::size_t few = 1000;
  return patches > std::max(few, many * without_lines);
}

// A mesh that is refined begins with patches that tell nothing of the size of details.
void set_detail(ContactLines& contacts, const Scene& scene, const Request& request, const KeptSides& sides) {
  constexpr double detail_of_accuracy = 18;  // fitted to two furnished rooms at 1 to 5 %
  constexpr double of_time = 0.01;           // an accuracy, where a time is asked for
  const bool by_accuracy = refines(request.accuracy) && !request.mesh.max_edge;
  if (has_error_bars(request.accuracy) && !by_accuracy) contacts.of_edge = 0.5;
  if (!by_accuracy) return;
  const double accuracy = request.accuracy.relative_error.value_or(of_time);
  contacts.detail = detail_of_accuracy * accuracy * std::sqrt(kept_area(scene, sides));
}

PlannedLines contacts_for(const Scene& scene, const Request& request, const KeptSides& sides) {
  if (!request.mesh.contact_lines) return {};
  if (largest_bend(scene) > weld_distance(scene))
    return {{},
            {"faces are bent by rounding, more than touching faces may be apart; patches follow the outlines of faces "
             "alone, wherever others touch them"}};
  ContactLines contacts = find_contact_lines(scene, sides);
  if (contacts.on.empty()) return {};
  if (const std::size_t lines = number_of(contacts); lines > most_lines)
    return {{},
            {std::to_string(lines) +
             " lines where faces touch, cross or end close before one are too many to cut faces at; patches follow the "
             "outlines of faces alone"}};
  set_detail(contacts, scene, request, sides);
  const std::size_t with_lines = least_patches(scene, sides, contacts);
  if (are_too_many(with_lines, least_patches(scene, sides)))
    return {{},
            {"patches that end where faces touch or cross would be " + std::to_string(with_lines) +
             " at least; they follow the outlines of faces alone"}};
  return {std::move(contacts), {}};
}

// The sun above the horizon, and luminaires without extent. Where these are many the shadow of one is faint.
std::vector<LightPlace> lights_with_hard_shadows(const Scene& scene, const std::vector<Effect>& skipped) {
  constexpr std::size_t many = 4;
  std::vector<LightPlace> lights;
  if (contains(skipped, Effect::occlusion)) return lights;
  if (scene.sun && scene.sun->direction.dot(scene.up) > 0 && !contains(skipped, Effect::sun))
    lights.push_back({scene.sun->direction, 0});
  if (contains(skipped, Effect::luminaires)) return lights;
  std::vector<LightPlace> luminaires;
  for (const Luminaire& luminaire : scene.luminaires) {
    if (!std::holds_alternative<SphericalLamp>(luminaire.light)) luminaires.push_back({luminaire.position, 1});
  }
  if (luminaires.size() <= many) lights.insert(lights.end(), luminaires.begin(), luminaires.end());
  return lights;
}

double area_of_faces(const Scene& scene) {
  double area = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) area += area_vector(corner_points(scene, p)).norm();
  return area;
}

// The same with the edges of hard shadows, unless these are too many.
PlannedLines with_shadow_edges(PlannedLines planned, const Scene& scene, const Request& request,
                               const KeptSides& sides) {
  const std::vector<LightPlace> lights = lights_with_hard_shadows(scene, request.effects.skip);
  const bool is_bent = largest_bend(scene) > weld_distance(scene);
  if (!request.mesh.contact_lines || lights.empty() || is_bent) return planned;
  const auto shadows = find_shadow_lines(scene, sides, lights);
  ContactLines all = planned.lines;
  all.on.resize(scene.polygons.size());
  if (all.size == 0) all.size = std::sqrt(area_of_faces(scene));
  std::size_t number = 0;
  for (std::size_t p = 0; p < shadows.size(); ++p) {
    all.on[p].insert(all.on[p].end(), shadows[p].begin(), shadows[p].end());
    number += shadows[p].size();
  }
  if (number == 0) return planned;
  set_detail(all, scene, request, sides);
  const bool fits =
      number_of(all) <= most_lines && !are_too_many(least_patches(scene, sides, all), least_patches(scene, sides));
  planned.notes.push_back(std::to_string(number) + " edges of shadows of the sun or of luminaires without extent are " +
                          (fits ? "lines at which patches end" : "too many to cut faces at; patches reach over them"));
  if (fits) planned.lines = std::move(all);
  return planned;
}

}  // namespace

PlannedLines planned_lines(const Scene& scene, const Request& request, const KeptSides& sides, bool knows_lights) {
  PlannedLines planned = contacts_for(scene, request, sides);
  return knows_lights ? with_shadow_edges(std::move(planned), scene, request, sides) : planned;
}

}  // namespace patchlight
