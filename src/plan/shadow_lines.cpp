#include "plan/shadow_lines.h"

#include "base/parallel.h"
#include "scene/coverings.h"
#include "scene/extent.h"
#include "visibility/occluder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>

namespace patchlight {
namespace {

constexpr std::size_t few_rays = 16;    // along an edge
constexpr std::size_t many_rays = 128;  // along one whose shadow is broken
constexpr std::size_t few_stretches = 2;
constexpr int bisections = 8;
constexpr double beside_edge = 1e-5;  // of the extent: how far from an edge rays pass it
constexpr double grazing = 0.02;      // sine; light that comes flatter draws shadows out without end
constexpr double seen_edge_on = 1e-6;

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
  if (across.norm() <= seen_edge_on * (edge.to - edge.from).norm()) return std::nullopt;
  bool left = false;
  bool right = false;
  for (const EdgeOfFace* face = first; face != last; ++face) {
    const double side = face->inward.dot(across.normalized());
    left = left || side < -seen_edge_on;
    right = right || side > seen_edge_on;
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
  double step;  // metres: how well loose ends are known
};

struct ShadowSearch {
  const Scene& scene;
  const KeptSides& kept;
  Occluder occluder;
  double beside;  // metres
  double touch;   // metres

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

// The polygons on which the shadows of evenly spread places of the edge fall.
std::vector<PolygonIndex> ShadowSearch::grounds_of(const Silhouette& edge, std::size_t rays) const {
  std::vector<PolygonIndex> grounds;
  for (std::size_t k = 0; k < rays; ++k)
    grounds.push_back(ground_below(edge, (static_cast<double>(k) + 0.5) / static_cast<double>(rays)));
  return grounds;
}

std::vector<ShadowLine> ShadowSearch::lines_of(const Silhouette& edge) const {
  std::vector<PolygonIndex> grounds = grounds_of(edge, few_rays);
  std::size_t changes = 0;
  for (std::size_t k = 1; k < grounds.size(); ++k) changes += grounds[k] == grounds[k - 1] ? 0 : 1;
  if (changes >= few_stretches) grounds = grounds_of(edge, many_rays);

  const std::size_t rays = grounds.size();
  const auto place = [rays](std::size_t k) { return (static_cast<double>(k) + 0.5) / static_cast<double>(rays); };
  std::vector<ShadowLine> lines;
  for (std::size_t first = 0, next = 0; first < rays; first = next) {
    const PolygonIndex ground = grounds[first];
    while (next < rays && grounds[next] == ground) ++next;
    if (ground == no_polygon) continue;
    const auto end_towards = [&](double inside, double outside) {
      return ground_below(edge, outside) == ground ? outside : border(edge, ground, inside, outside);
    };
    constexpr double almost = 1e-6;  // rays at the very ends pass the neighbour's edges
    const double from = end_towards(place(first), first == 0 ? almost : place(first - 1));
    const double to = end_towards(place(next - 1), next == rays ? 1 - almost : place(next));
    const std::array loose{from > almost, to < 1 - almost};
    const auto begin = shadow_of(edge, loose[0] ? from : 0, ground);
    const auto end = shadow_of(edge, loose[1] ? to : 1, ground);
    if (!begin || !end || (*end - *begin).norm() <= touch) continue;
    const double step = (*end - *begin).norm() / (to - from) / static_cast<double>(rays << bisections);
    lines.push_back({ground, {*begin, *end, 0}, loose, 4 * step + beside});
  }
  return lines;
}

// Where a line meets another of the same plane, as a part of its length; nothing where it passes by the other.
std::optional<double> meeting(const ContactLine& line, const Point& from, const Point& to, double near) {
  const Vector along = line.to - line.from;
  const Vector other = to - from;
  const Vector turn = along.cross(other);
  if (turn.norm() <= seen_edge_on * along.norm() * other.norm()) return std::nullopt;
  const double on_other = (line.from - from).cross(along).dot(other.cross(along)) / turn.squaredNorm();
  const double margin = near / other.norm();
  if (on_other < -margin || on_other > 1 + margin) return std::nullopt;
  return (from - line.from).cross(other).dot(turn) / turn.squaredNorm();
}

// Moves loose ends to what they nearly reach: to the nearest of the polygon's edges and other lines.
void tie_loose_ends(std::vector<ShadowLine>& lines, const std::vector<Point>& corners) {
  constexpr std::size_t too_many = 5000;  // for pairs of them
  if (lines.size() > too_many) return;
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

}  // namespace

std::vector<std::vector<ContactLine>> find_shadow_lines(const Scene& scene, const KeptSides& kept,
                                                        const Coverings& coverings,
                                                        const std::vector<LightPlace>& lights) {
  const std::vector<Silhouette> edges = silhouettes(scene, lights);
  const ShadowSearch search{scene, kept, Occluder(scene, Occluder::Blockers::opaque, coverings),
                            beside_edge * extent_of(scene), weld_distance(scene)};
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

}  // namespace patchlight
