#include "plan/planned_lines.h"

#include "mesh/mesher.h"
#include "plan/shadow_lines.h"
#include "scene/extent.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

// So many are followed at most: with the longest 40,000 of a house in IFC and 100,000 patches its walls stay whole,
// edges being 4.3 m long and not 1.7, and planning takes twice as long.
constexpr std::size_t most_lines = 10'000;

// Patches of this length and as many as these are cut off by lines at most.
struct Room {
  double max_edge;   // metres
  std::size_t most;  // patches
};

// Three times as many as without lines, of parents twice as large as patches: where there are more, faces of a damaged
// model cross anywhere. Patches that no memory holds are refused later, and not counted.
Room room_for_lines(const Scene& scene, const Request& request, const KeptSides& sides) {
  constexpr std::size_t few = 1000;
  constexpr std::size_t many = 3;
  constexpr double beyond_memory = 1e7;
  double edge = 0;
  if (request.mesh.max_edge) {
    edge = 2 * *request.mesh.max_edge;
  } else {
    const std::size_t least = least_patches(scene, sides);
    edge = max_edge_for(scene, sides, std::max(patches_asked(request) / 4, least + least / 4));
  }
  if (kept_area(scene, sides) > beyond_memory * edge * edge) return {edge, 0};
  return {edge, std::max(few, many * number_of_patches(scene, sides, edge))};
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

std::int64_t rounded_length(const ContactLine& line) {
  return std::llround(std::log2((line.to - line.from).squaredNorm()) * 0x1p20);
}

// The longest of the lines, so many of them; of equal ones the first.
ContactLines longest_of(const ContactLines& all, std::size_t number) {
  if (number >= number_of(all)) return all;
  struct Place {
    std::int64_t length;  // 2^20 log2 of its square: lengths that differ by rounding alone are equal
    std::size_t polygon, line;
  };
  std::vector<Place> places;
  for (std::size_t p = 0; p < all.on.size(); ++p) {
    for (std::size_t k = 0; k < all.on[p].size(); ++k) places.push_back({rounded_length(all.on[p][k]), p, k});
  }
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(number), places.end(),
                   [](const Place& a, const Place& b) {
                     return std::tuple(-a.length, a.polygon, a.line) < std::tuple(-b.length, b.polygon, b.line);
                   });
  places.resize(number);
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tuple(a.polygon, a.line) < std::tuple(b.polygon, b.line);
  });
  ContactLines some = all;
  some.on.assign(all.on.size(), {});
  for (const Place& place : places) some.on[place.polygon].push_back(all.on[place.polygon][place.line]);
  return some;
}

Diagnostics note_on_bent_faces(const std::vector<std::uint8_t>& is_bent) {
  const auto number = std::count(is_bent.begin(), is_bent.end(), 1);
  if (number == 0) return {};
  return {{DiagnosticCode::contact_lines,
           std::to_string(number) +
               " faces are bent by rounding, or beside such faces, by more than touching faces may be apart; on these "
               "patches follow the outline alone, wherever others touch them"}};
}

// The long lines are those on which much light depends: where all are too many, half of them are followed, or half of
// these, until they leave room.
ContactLines followed_of(const ContactLines& all, const Scene& scene, const Request& request, const KeptSides& sides) {
  const auto longest = [&](std::size_t number) {
    ContactLines followed = longest_of(all, number);
    set_detail(followed, scene, request, sides);
    return followed;
  };
  if (request.mesh.contact_line_count) return longest(*request.mesh.contact_line_count);
  const Room room = room_for_lines(scene, request, sides);
  if (room.most == 0) return {};
  for (std::size_t number = std::min(number_of(all), most_lines); number > 0; number /= 2) {
    ContactLines followed = longest(number);
    if (number_of_patches(scene, sides, room.max_edge, followed) <= room.most) return followed;
  }
  return {};
}

std::string note_on_lines(std::size_t all, std::size_t followed) {
  const std::string found = "of " + std::to_string(all) + " lines where faces touch, cross or end close before one, ";
  return found + (followed == 0 ? "all cut off too many patches; patches follow the outlines of faces alone"
                                : "patches end at the " + std::to_string(followed) + " longest");
}

PlannedLines contacts_for(const Scene& scene, const Request& request, const KeptSides& sides) {
  if (!request.mesh.contact_lines) return {};
  PlannedLines planned{{}, note_on_bent_faces(bent_faces(scene))};
  const ContactLines all = find_contact_lines(scene, sides);
  if (all.everywhere)
    planned.notes.push_back({DiagnosticCode::contact_lines,
                             "faces touch or cross nearly everywhere; patches follow the outlines of faces alone"});
  if (all.on.empty()) return planned;
  planned.lines = followed_of(all, scene, request, sides);
  if (const std::size_t number = number_of(planned.lines); number < number_of(all))
    planned.notes.push_back({DiagnosticCode::contact_lines, note_on_lines(number_of(all), number)});
  return planned;
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
PlannedLines with_shadow_edges(PlannedLines planned, const Scene& scene, const Request& request, const KeptSides& sides,
                               const Coverings& coverings) {
  const std::vector<LightPlace> lights = lights_with_hard_shadows(scene, request.effects.skip);
  if (!request.mesh.contact_lines || lights.empty()) return planned;
  const std::vector<std::uint8_t> is_bent = bent_faces(scene);
  const auto shadows = find_shadow_lines(scene, sides, coverings, lights);
  ContactLines all = planned.lines;
  all.on.resize(scene.polygons.size());
  if (all.size == 0) all.size = std::sqrt(area_of_faces(scene));
  std::size_t number = 0;
  for (std::size_t p = 0; p < shadows.size(); ++p) {
    if (is_bent[p]) continue;
    all.on[p].insert(all.on[p].end(), shadows[p].begin(), shadows[p].end());
    number += shadows[p].size();
  }
  if (number == 0) return planned;
  set_detail(all, scene, request, sides);
  // Shadows may take as much room again as contacts.
  const Room room = room_for_lines(scene, request, sides);
  const bool fits = number <= most_lines && number_of_patches(scene, sides, room.max_edge, all) <= 2 * room.most;
  planned.notes.push_back(
      {DiagnosticCode::shadow_edges,
       std::to_string(number) + " edges of shadows of the sun or of luminaires without extent are " +
           (fits ? "lines at which patches end" : "too many to cut faces at; patches reach over them")});
  if (fits) planned.lines = std::move(all);
  return planned;
}

}  // namespace

PlannedLines planned_lines(const Scene& scene, const Request& request, const KeptSides& sides,
                           const Coverings& coverings, bool knows_lights) {
  PlannedLines planned = contacts_for(scene, request, sides);
  return knows_lights ? with_shadow_edges(std::move(planned), scene, request, sides, coverings) : planned;
}

}  // namespace patchlight
