#include "plan/planned_lines.h"

#include "base/parallel.h"
#include "base/tolerances.h"
#include "mesh/mesher.h"
#include "plan/survey.h"
#include "scene/extent.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

namespace patchlight {
namespace {

constexpr int bisections = 8;
constexpr double grazing = 0.02;  // sine; light that comes flatter draws shadows out without end

// An edge with a polygon that has it.
struct EdgeOfFace {
  std::uint32_t low, high;
  PolygonIndex polygon;
  Vector inward;  // across the edge, into the polygon
};

std::vector<EdgeOfFace> opaque_edges(const Scene& scene) {
  std::vector<EdgeOfFace> edges;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (is_opening(scene, p)) continue;
    const Vector normal = front_normal(scene, p);
    const auto& corners = scene.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t from = corners[k];
      const std::uint32_t to = corners[(k + 1) % corners.size()];
      const Vector inward = normal.cross(scene.vertices[to] - scene.vertices[from]).normalized();
      edges.push_back({std::min(from, to), std::max(from, to), p, inward});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const EdgeOfFace& a, const EdgeOfFace& b) {
    return std::tuple(a.low, a.high, a.polygon) < std::tuple(b.low, b.high, b.polygon);
  });
  return edges;
}

// An edge that light passes on one side only.
struct Silhouette {
  Point from, to;
  Vector outward;  // across the edge and the light, away from the faces, of length 1
  const LightPlace* light;

  Point at(double t) const { return from + t * (to - from); }
};

// All faces of an edge, from first to last, have to lie to one side of the plane through it and the light.
std::optional<Silhouette> silhouette_of(const Scene& scene, const EdgeOfFace* first, const EdgeOfFace* last,
                                        const LightPlace& light) {
  Silhouette edge{scene.vertices[first->low], scene.vertices[first->high], Vector::Zero(), &light};
  const Vector across = (edge.to - edge.from).cross(light.way_from(edge.at(0.5)).normalized());
  if (across.norm() <= tolerance_of_coordinates * (edge.to - edge.from).norm()) return std::nullopt;
  bool left = false;
  bool right = false;
  for (const EdgeOfFace* face = first; face != last; ++face) {
    const double side = face->inward.dot(across.normalized());
    left = left || side < -tolerance_of_coordinates;
    right = right || side > tolerance_of_coordinates;
  }
  if (left == right) return std::nullopt;
  edge.outward = (left ? 1 : -1) * across.normalized();
  return edge;
}

std::vector<Silhouette> silhouettes(const Scene& scene, const std::vector<LightPlace>& lights) {
  const std::vector<EdgeOfFace> edges = opaque_edges(scene);
  std::vector<Silhouette> found;
  for (std::size_t k = 0, next = 0; k < edges.size(); k = next) {
    while (next < edges.size() && edges[next].low == edges[k].low && edges[next].high == edges[k].high) ++next;
    for (const LightPlace& light : lights) {
      if (const auto edge = silhouette_of(scene, edges.data() + k, edges.data() + next, light)) found.push_back(*edge);
    }
  }
  return found;
}

// A line on a polygon. Ends that are not those of the edge are known to a part of its length.
struct ShadowLine {
  PolygonIndex polygon;
  ContactLine line;
  std::array<bool, 2> is_loose;
  double step;  // meters: the accuracy of loose ends
};

struct ShadowSearch {
  const Scene& scene;
  const KeptSides& kept;
  Occluder occluder;
  double beside;  // meters: how far from an edge rays pass it
  double touch;   // meters

  PolygonIndex ground_below(const Silhouette& edge, double t) const;
  std::optional<Point> shadow_of(const Silhouette& edge, double t, PolygonIndex ground) const;
  double border(const Silhouette& edge, PolygonIndex ground, double inside, double outside) const;
  std::vector<PolygonIndex> grounds_of(const Silhouette& edge, std::size_t rays) const;
  std::vector<ShadowLine> lines_of(const Silhouette& edge) const;
};

// The polygon on which light falls that just passes the edge, if any.
PolygonIndex ShadowSearch::ground_below(const Silhouette& edge, double t) const {
  const Point place = edge.at(t) + beside * edge.outward;
  const Vector way = edge.light->way_from(place);
  const Vector toward = way.normalized();
  const bool is_far = edge.light->weight == 0;
  const bool blocked = is_far ? occluder.first_hits(std::array{Ray{place, toward}})[0].has_value()
                              : occluder.occluded(std::array{Segment{place, edge.light->at}})[0] != 0;
  if (blocked) return no_polygon;
  const auto hit = occluder.first_hits(std::array{Ray{place, -toward}})[0];
  if (!hit || hit->distance <= touch) return no_polygon;
  const auto& sides = hit->side == Side::front ? kept.front : kept.back;
  const double sine = std::abs(front_normal(scene, hit->polygon).dot(toward));
  return sides[hit->polygon] != 0 && sine > grazing ? hit->polygon : no_polygon;
}

// Where the shadow of a place of the edge lies in the plane of a polygon.
std::optional<Point> ShadowSearch::shadow_of(const Silhouette& edge, double t, PolygonIndex ground) const {
  const Vector normal = front_normal(scene, ground);
  const Vector way = edge.light->way_from(edge.at(t));
  const double height = normal.dot(edge.at(t) - scene.vertices[scene.polygons[ground].corners[0]]);
  const double climb = normal.dot(way);
  const bool is_past_light = height * climb < 0 && std::abs(height) > touch;
  if (std::abs(climb) <= grazing * way.norm() || is_past_light) return std::nullopt;
  return edge.at(t) - height / climb * way;
}

// Where between two places of the edge its shadow leaves a polygon: just beyond, unless it has no end there.
double ShadowSearch::border(const Silhouette& edge, PolygonIndex ground, double inside, double outside) const {
  for (int k = 0; k < bisections; ++k) {
    const double middle = (inside + outside) / 2;
    (ground_below(edge, middle) == ground ? inside : outside) = middle;
  }
  return shadow_of(edge, outside, ground) ? outside : inside;
}

// Evenly spread places of an edge.
double place_of_ray(std::size_t k, std::size_t rays) {
  return (static_cast<double>(k) + 0.5) / static_cast<double>(rays);
}

// The polygons on which the shadows of these places fall.
std::vector<PolygonIndex> ShadowSearch::grounds_of(const Silhouette& edge, std::size_t rays) const {
  std::vector<PolygonIndex> grounds;
  for (std::size_t k = 0; k < rays; ++k) grounds.push_back(ground_below(edge, place_of_ray(k, rays)));
  return grounds;
}

std::vector<ShadowLine> ShadowSearch::lines_of(const Silhouette& edge) const {
  std::vector<PolygonIndex> grounds = grounds_of(edge, 16);
  std::size_t changes = 0;
  for (std::size_t k = 1; k < grounds.size(); ++k) changes += grounds[k] == grounds[k - 1] ? 0 : 1;
  if (changes >= 2) grounds = grounds_of(edge, 128);  // the shadow is broken

  const std::size_t rays = grounds.size();
  std::vector<ShadowLine> lines;
  for (std::size_t first = 0, next = 0; first < rays; first = next) {
    const PolygonIndex ground = grounds[first];
    while (next < rays && grounds[next] == ground) ++next;
    if (ground == no_polygon) continue;
    const auto end_towards = [&](double inside, double outside) {
      return ground_below(edge, outside) == ground ? outside : border(edge, ground, inside, outside);
    };
    // Rays at the very ends pass the neighbor's edges.
    const double first_place = tolerance_of_coordinates, last_place = 1 - tolerance_of_coordinates;
    const double from =
        end_towards(place_of_ray(first, rays), first == 0 ? first_place : place_of_ray(first - 1, rays));
    const double to = end_towards(place_of_ray(next - 1, rays), next == rays ? last_place : place_of_ray(next, rays));
    const std::array loose{from > first_place, to < last_place};
    const auto begin = shadow_of(edge, loose[0] ? from : 0, ground);
    const auto end = shadow_of(edge, loose[1] ? to : 1, ground);
    if (!begin || !end || (*end - *begin).norm() <= touch) continue;
    const double step = (*end - *begin).norm() / (to - from) / static_cast<double>(rays << bisections);
    lines.push_back({ground, {*begin, *end, 0}, loose, 4 * step + beside});
  }
  return lines;
}

// The intersection of a line with another in the same plane, as a fraction of its length; nothing if they do not cross.
std::optional<double> meeting(const ContactLine& line, const Point& from, const Point& to, double near) {
  const Vector along = line.to - line.from;
  const Vector other = to - from;
  const Vector turn = along.cross(other);
  if (turn.norm() <= tolerance_of_coordinates * along.norm() * other.norm()) return std::nullopt;
  const double on_other = (line.from - from).cross(along).dot(other.cross(along)) / turn.squaredNorm();
  const double margin = near / other.norm();
  if (on_other < -margin || on_other > 1 + margin) return std::nullopt;
  return (from - line.from).cross(other).dot(turn) / turn.squaredNorm();
}

// Moves each loose end to the nearest edge of the polygon or other line, if it nearly reaches it.
void tie_loose_ends(std::vector<ShadowLine>& lines, const std::vector<Point>& corners) {
  if (lines.size() > 5000) return;  // too many for a look at all pairs
  const std::vector<ShadowLine> before = lines;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const ContactLine& line = before[k].line;
    const double length = (line.to - line.from).norm();
    for (const std::size_t end : {0U, 1U}) {
      if (!before[k].is_loose[end]) continue;
      double nearest = before[k].step / length;
      const auto try_line = [&](const Point& from, const Point& to) {
        const auto t = meeting(line, from, to, before[k].step);
        if (!t || std::abs(*t - static_cast<double>(end)) > nearest) return;
        nearest = std::abs(*t - static_cast<double>(end));
        (end == 0 ? lines[k].line.from : lines[k].line.to) = line.from + *t * (line.to - line.from);
      };
      for (std::size_t c = 0; c < corners.size(); ++c) try_line(corners[c], corners[(c + 1) % corners.size()]);
      for (std::size_t l = 0; l < before.size(); ++l) {
        if (l != k) try_line(before[l].line.from, before[l].line.to);
      }
    }
  }
}

// Faces that meet there without the same vertices throw each other's outlines.
bool is_along_outline(const ContactLine& line, const std::vector<Point>& corners, double near) {
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Vector edge = corners[(c + 1) % corners.size()] - corners[c];
    const auto is_on_edge = [&](const Point& point) {
      const double t = std::clamp((point - corners[c]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      return (point - corners[c] - t * edge).norm() <= near;
    };
    if (is_on_edge(line.from) && is_on_edge(line.to)) return true;
  }
  return false;
}

// So many are followed at most: with the longest 40,000 of a house in IFC and 100,000 patches its walls stay whole,
// edges being 4.3 m long and not 1.7, and planning takes twice as long.
constexpr std::size_t most_lines = 10'000;

// Limits on the patches that lines cut off.
struct Room {
  double max_edge;   // meters
  std::size_t most;  // patches
};

// Three times as many as without lines, of parents twice as large as patches: where there are more, faces of a damaged
// model cross anywhere. Patches that no memory holds are refused later, and not counted.
Room room_for_lines(const Scene& scene, const Request& request, const KeptSides& sides) {
  double edge = 0;
  if (request.mesh.max_edge) {
    edge = 2 * *request.mesh.max_edge;
  } else {
    const std::size_t least = least_patches(scene, sides);
    edge = max_edge_for(scene, sides, std::max(patches_asked(request) / 4, least + least / 4));
  }
  if (kept_area(scene, sides) > 1e7 * edge * edge) return {edge, 0};
  return {edge, std::max<std::size_t>(1000, 3 * number_of_patches(scene, sides, edge))};
}

// A mesh that is refined starts with patches of a size unrelated to the details of the model.
void set_detail(ContactLines& contacts, const Scene& scene, const Request& request, const KeptSides& sides) {
  const bool by_accuracy = refines(request.accuracy) && !request.mesh.max_edge;
  if (has_error_bars(request.accuracy) && !by_accuracy) contacts.of_edge = 0.5;
  if (!by_accuracy) return;
  // An accuracy of 1 % stands for a time. The factor is fitted to two furnished rooms at 1 to 5 %.
  contacts.detail = 18 * request.accuracy.relative_error.value_or(0.01) * std::sqrt(kept_area(scene, sides));
}

std::int64_t rounded_length(const ContactLine& line) {
  return std::llround(std::log2((line.to - line.from).squaredNorm()) * 0x1p20);
}

// The `number` longest lines; ties in their order.
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
  return {
      {DiagnosticCode::contact_lines,
       std::to_string(number) +
           " faces are bent by rounding, or lie beside such faces, by more than the tolerance for touching faces; on "
           "these, patches follow the outline only, not the faces that touch them"}};
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
  const std::string found = "of " + std::to_string(all) + " lines where faces touch, cross or nearly touch, ";
  return found + (followed == 0 ? "all would create too many patches; patches follow the outlines of faces only"
                                : "patches end at the " + std::to_string(followed) + " longest");
}

PlannedLines contacts_for(const Scene& scene, const Request& request, const KeptSides& sides) {
  if (!request.mesh.contact_lines) return {};
  PlannedLines planned{{}, note_on_bent_faces(bent_faces(scene))};
  const ContactLines all = find_contact_lines(scene, sides);
  if (all.everywhere)
    planned.notes.push_back({DiagnosticCode::contact_lines,
                             "faces touch or cross nearly everywhere; patches follow the outlines of faces only"});
  if (all.on.empty()) return planned;
  planned.lines = followed_of(all, scene, request, sides);
  if (const std::size_t number = number_of(planned.lines); number < number_of(all))
    planned.notes.push_back({DiagnosticCode::contact_lines, note_on_lines(number_of(all), number)});
  return planned;
}

// The sun above the horizon, and luminaires without extent. Where these are many the shadow of one is faint.
std::vector<LightPlace> lights_with_hard_shadows(const Scene& scene, const std::vector<Effect>& skipped) {
  std::vector<LightPlace> lights;
  if (contains(skipped, Effect::occlusion)) return lights;
  if (scene.sun && scene.sun->direction.dot(scene.up) > 0 && !contains(skipped, Effect::sun))
    lights.push_back({scene.sun->direction, 0});
  if (contains(skipped, Effect::luminaires)) return lights;
  std::vector<LightPlace> luminaires;
  for (const Luminaire& luminaire : scene.luminaires) {
    if (!std::holds_alternative<SphericalLamp>(luminaire.light)) luminaires.push_back({luminaire.position, 1});
  }
  if (luminaires.size() <= 4) lights.insert(lights.end(), luminaires.begin(), luminaires.end());
  return lights;
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
           (fits ? "lines at which patches end" : "too many to cut faces at; patches extend across them")});
  if (fits) planned.lines = std::move(all);
  return planned;
}

}  // namespace

std::vector<std::vector<ContactLine>> find_shadow_lines(const Scene& scene, const KeptSides& kept,
                                                        const Coverings& coverings,
                                                        const std::vector<LightPlace>& lights) {
  const std::vector<Silhouette> edges = silhouettes(scene, lights);
  const ShadowSearch search{scene, kept, Occluder(scene, Occluder::Blockers::opaque, coverings),
                            1e-5 * extent_of(scene), weld_distance(scene)};
  std::vector<std::vector<ShadowLine>> found(edges.size());
  parallel_for(edges.size(), [&](std::size_t k) { found[k] = search.lines_of(edges[k]); });
  std::vector<std::vector<ShadowLine>> on(scene.polygons.size());
  for (const auto& some : found) {
    for (const ShadowLine& line : some) on[line.polygon].push_back(line);
  }
  std::vector<std::vector<ContactLine>> lines(scene.polygons.size());
  parallel_for(on.size(), [&](std::size_t p) {
    const std::vector<Point> corners = corner_points(scene, static_cast<PolygonIndex>(p));
    tie_loose_ends(on[p], corners);
    for (const ShadowLine& line : on[p]) {
      if (!is_along_outline(line.line, corners, 4 * search.beside)) lines[p].push_back(line.line);
    }
  });
  return lines;
}

PlannedLines planned_lines(const Scene& scene, const Request& request, const KeptSides& sides,
                           const Coverings& coverings, bool knows_lights) {
  PlannedLines planned = contacts_for(scene, request, sides);
  return knows_lights ? with_shadow_edges(std::move(planned), scene, request, sides, coverings) : planned;
}

}  // namespace patchlight
