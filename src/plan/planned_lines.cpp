#include "plan/planned_lines.h"

#include "mesh/mesher.h"
#include "plan/shadow_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

// To cut faces at more lines takes longer than light through them; so few are followed however short they are.
constexpr std::size_t most_lines = 20'000;
constexpr std::size_t many_lines = 5'000;

// How long patches are that follow no lines, as parents twice as large as patches, and how many there may be of as long
// ones that do: twice as many, and at least as many as light through them takes no time.
struct Room {
  double max_edge;   // metres
  std::size_t most;  // patches
};

Room room_for_lines(const Scene& scene, const Request& request, const KeptSides& sides) {
  constexpr std::size_t few = 5000;
  const double edge =
      request.mesh.max_edge ? 2 * *request.mesh.max_edge : max_edge_for(scene, sides, patches_asked(request) / 4);
  return {edge, 2 * std::max(few, number_of_patches(scene, sides, edge))};
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

// The longest of the lines, so many of them; of equal ones the first.
ContactLines longest_of(const ContactLines& all, std::size_t number) {
  if (number >= number_of(all)) return all;
  struct Place {
    double square;  // of the length
    std::size_t polygon, line;
  };
  std::vector<Place> places;
  for (std::size_t p = 0; p < all.on.size(); ++p) {
    for (std::size_t k = 0; k < all.on[p].size(); ++k)
      places.push_back({(all.on[p][k].to - all.on[p][k].from).squaredNorm(), p, k});
  }
  std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(number), places.end(),
                   [](const Place& a, const Place& b) {
                     return std::tuple(-a.square, a.polygon, a.line) < std::tuple(-b.square, b.polygon, b.line);
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

std::vector<std::string> note_on_bent_faces(const std::vector<std::uint8_t>& is_bent) {
  const auto number = std::count(is_bent.begin(), is_bent.end(), 1);
  if (number == 0) return {};
  return {std::to_string(number) +
          " faces are bent by rounding, more than touching faces may be apart; on these patches follow the outline "
          "alone, wherever others touch them"};
}

std::size_t number_longer_than(double length, const ContactLines& lines) {
  const auto is_longer = [&](const ContactLine& line) { return (line.to - line.from).norm() > length; };
  std::size_t number = 0;
  for (const auto& on_face : lines.on)
    number += static_cast<std::size_t>(std::count_if(on_face.begin(), on_face.end(), is_longer));
  return number;
}

// The long lines are those on which much light depends: where there are many, those are left out that are far shorter
// than patches are long, and where all are too many, half of them are followed, or half of these, until they leave
// room.
ContactLines followed_of(const ContactLines& all, const Scene& scene, const Request& request, const KeptSides& sides) {
  constexpr double far_shorter = 0.125;  // of the edge of parents
  const Room room = room_for_lines(scene, request, sides);
  const std::size_t worth_it = std::max(many_lines, number_longer_than(far_shorter * room.max_edge, all));
  for (std::size_t number = std::min({number_of(all), most_lines, worth_it}); number > 0; number /= 2) {
    ContactLines followed = longest_of(all, number);
    set_detail(followed, scene, request, sides);
    if (number_of_patches(scene, sides, room.max_edge, followed) <= room.most) return followed;
  }
  return {};
}

PlannedLines contacts_for(const Scene& scene, const Request& request, const KeptSides& sides) {
  if (!request.mesh.contact_lines) return {};
  PlannedLines planned{{}, note_on_bent_faces(bent_faces(scene))};
  const ContactLines all = find_contact_lines(scene, sides);
  if (all.on.empty()) return planned;
  planned.lines = followed_of(all, scene, request, sides);
  if (const std::size_t number = number_of(planned.lines); number < number_of(all))
    planned.notes.push_back("of " + std::to_string(number_of(all)) +
                            " lines where faces touch, cross or end close before one, patches end at the " +
                            std::to_string(number) + " longest");
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
PlannedLines with_shadow_edges(PlannedLines planned, const Scene& scene, const Request& request,
                               const KeptSides& sides) {
  const std::vector<LightPlace> lights = lights_with_hard_shadows(scene, request.effects.skip);
  if (!request.mesh.contact_lines || lights.empty()) return planned;
  const std::vector<std::uint8_t> is_bent = bent_faces(scene);
  const auto shadows = find_shadow_lines(scene, sides, lights);
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
  const Room room = room_for_lines(scene, request, sides);
  const bool fits =
      number_of(all) <= most_lines && number_of_patches(scene, sides, room.max_edge, all) <= 2 * room.most;
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
