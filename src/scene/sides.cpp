#include "patchlight/scene/sides.h"

#include "patchlight/scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>

namespace patchlight {
namespace {

// Vertices nearer than this share of the scene's extent along every axis are the same place.
constexpr double weld_tolerance = 1e-9;

// How far before its front a lamp is looked for, as a share of the scene's extent.
constexpr double lamp_offset = 1e-6;

// A closed surface encloses a volume when it is larger than this share of its area times its extent; the fold of two
// coincident polygons does not.
constexpr double volume_tolerance = 1e-9;

// One polygon walking along one edge, between welded vertices.
struct EdgeUse {
  std::uint32_t low, high;  // the vertices, low < high
  PolygonIndex polygon;
  bool upward;  // from low to high

  bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

// A closed, consistently oriented set of polygons.
struct Solid {
  std::vector<PolygonIndex> polygons;
  bool fronts_face_inside = false;
  Box box;
  std::vector<std::array<Point, 3>> triangles;  // oriented as the polygons
};

// For one coordinate of all vertices: numbers equal for values no farther than the tolerance from their neighbours.
std::vector<std::uint32_t> clusters(const std::vector<Point>& vertices, int axis, double tolerance) {
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return vertices[a][axis] < vertices[b][axis]; });
  std::vector<std::uint32_t> number(vertices.size(), 0);
  for (std::size_t k = 1; k < order.size(); ++k) {
    const bool is_new = vertices[order[k]][axis] - vertices[order[k - 1]][axis] > tolerance;
    number[order[k]] = number[order[k - 1]] + (is_new ? 1 : 0);
  }
  return number;
}

// For every vertex the number of its place: vertices at the same position share it.
std::vector<std::uint32_t> welded(const Scene& scene) {
  const Box box = bounds(scene);
  const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * farthest;
  const double tolerance = std::max(weld_tolerance * box.sizes().maxCoeff(), rounding);
  const std::array<std::vector<std::uint32_t>, 3> cluster = {clusters(scene.vertices, 0, tolerance),
                                                             clusters(scene.vertices, 1, tolerance),
                                                             clusters(scene.vertices, 2, tolerance)};
  const auto place = [&](std::uint32_t v) { return std::array{cluster[0][v], cluster[1][v], cluster[2][v]}; };
  std::vector<std::uint32_t> order(scene.vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
  std::vector<std::uint32_t> number(scene.vertices.size(), 0);
  for (std::size_t k = 1; k < order.size(); ++k) {
    number[order[k]] = number[order[k - 1]] + (place(order[k]) == place(order[k - 1]) ? 0 : 1);
  }
  return number;
}

// All edge uses, those of the same edge side by side.
std::vector<EdgeUse> edge_uses(const Scene& scene) {
  const std::vector<std::uint32_t> place = welded(scene);
  std::vector<EdgeUse> uses;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const std::uint32_t from = place[corners[k]];
      const std::uint32_t to = place[corners[(k + 1) % corners.size()]];
      if (from != to) uses.push_back({std::min(from, to), std::max(from, to), p, from < to});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) {
    return std::array{a.low, a.high, a.polygon} < std::array{b.low, b.high, b.polygon};
  });
  return uses;
}

// For every polygon the smallest index of a polygon it is connected to by shared edges.
std::vector<PolygonIndex> components(std::size_t polygons, const std::vector<EdgeUse>& uses) {
  std::vector<PolygonIndex> link(polygons);  // a forest; every link leads to a smaller index or to itself
  std::iota(link.begin(), link.end(), PolygonIndex{0});
  const auto root = [&link](PolygonIndex polygon) {
    while (link[polygon] != polygon) polygon = link[polygon] = link[link[polygon]];  // halve the path on the way
    return polygon;
  };
  for (std::size_t k = 1; k < uses.size(); ++k) {
    if (!uses[k].same_edge(uses[k - 1])) continue;
    const PolygonIndex a = root(uses[k].polygon);
    const PolygonIndex b = root(uses[k - 1].polygon);
    link[std::max(a, b)] = std::min(a, b);
  }
  for (PolygonIndex p = 0; p < polygons; ++p) link[p] = root(p);
  return link;
}

// Per component, named by its smallest polygon: does each edge belong to two uses in opposite directions?
std::vector<std::uint8_t> closed_components(const std::vector<PolygonIndex>& component,
                                            const std::vector<EdgeUse>& uses) {
  std::vector<std::uint8_t> closed(component.size(), 1);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].same_edge(uses[begin])) ++end;
    const bool paired = end - begin == 2 && uses[begin].upward != uses[begin + 1].upward;
    if (!paired) closed[component[uses[begin].polygon]] = 0;
  }
  return closed;
}

// The solid of these polygons with its triangles and the direction its fronts face; no triangles if it has no volume.
Solid make_solid(const Scene& scene, std::vector<PolygonIndex> polygons) {
  Solid solid;
  for (const PolygonIndex p : polygons) {
    const std::vector<Point> corners = corner_points(scene, p);
    for (const Point& corner : corners) solid.box.extend(corner);
    for (const auto& [a, b, c] : triangulate(corners)) solid.triangles.push_back({corners[a], corners[b], corners[c]});
  }
  solid.polygons = std::move(polygons);

  // V = 1/6 sum (a - o) . ((b - o) x (c - o)), positive when the fronts face outward.
  const Point origin = solid.box.center();
  double volume = 0;
  double area = 0;
  for (const auto& [a, b, c] : solid.triangles) {
    volume += (a - origin).dot((b - origin).cross(c - origin)) / 6;
    area += (b - a).cross(c - a).norm() / 2;
  }
  solid.fronts_face_inside = volume < 0;
  if (std::abs(volume) <= volume_tolerance * area * solid.box.diagonal().norm()) solid.triangles.clear();
  return solid;
}

std::vector<Solid> closed_solids(const Scene& scene) {
  const std::vector<EdgeUse> uses = edge_uses(scene);
  const std::vector<PolygonIndex> component = components(scene.polygons.size(), uses);
  const std::vector<std::uint8_t> closed = closed_components(component, uses);
  std::vector<std::vector<PolygonIndex>> members(scene.polygons.size());
  for (PolygonIndex p = 0; p < component.size(); ++p) members[component[p]].push_back(p);

  std::vector<Solid> solids;
  for (PolygonIndex p = 0; p < component.size(); ++p) {
    if (component[p] != p || !closed[p]) continue;
    Solid solid = make_solid(scene, std::move(members[p]));
    if (!solid.triangles.empty()) solids.push_back(std::move(solid));
  }
  return solids;
}

// A point just before the front of every lamp: over the middle of its largest triangle, which is inside the polygon
// even when that is not convex.
std::vector<Point> points_before_lamps(const Scene& scene) {
  const double offset = lamp_offset * bounds(scene).diagonal().norm();
  std::vector<Point> points;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    if (!is_lamp(scene, p)) continue;
    const std::vector<Point> corners = corner_points(scene, p);
    double largest = 0;
    Point middle = corners[0];
    for (const auto& [a, b, c] : triangulate(corners)) {
      const double area = (corners[b] - corners[a]).cross(corners[c] - corners[a]).norm();
      if (area <= largest) continue;
      largest = area;
      middle = (corners[a] + corners[b] + corners[c]) / 3;
    }
    points.push_back(middle + offset * front_normal(scene, p));
  }
  return points;
}

bool holds(const Solid& solid, const Point& point) {
  if (!solid.box.contains(point)) return false;
  double solid_angle = 0;
  for (const auto& [a, b, c] : solid.triangles) solid_angle += signed_solid_angle(point, a, b, c);
  return std::abs(std::lround(solid_angle / (4 * std::numbers::pi))) == 1;
}

// Counts for the notes.
struct Count {
  int dark = 0;     // solids without a lamp: inner sides left out
  int outside = 0;  // solids that hold every lamp: outer sides left out
  int outward = 0;  // solids with outward normals that hold a lamp: inner sides kept
  std::uint32_t first_outward_line = 0;
};

std::vector<std::string> notes_on(const Count& count) {
  const auto solids = [](int number) {
    return std::to_string(number) + (number == 1 ? " closed solid" : " closed solids");
  };
  std::vector<std::string> notes;
  if (count.dark > 0) notes.push_back("the inner sides of " + solids(count.dark) + " without a lamp are left out");
  if (count.outside > 0) {
    notes.push_back("the outer sides of " + solids(count.outside) + " around all lamps are left out");
  }
  if (count.outward > 0) {
    const std::string line =
        count.first_outward_line > 0 ? " (line " + std::to_string(count.first_outward_line) + ")" : std::string();
    notes.push_back(solids(count.outward) + line + " with outward normals around a lamp: the inner sides are used");
  }
  return notes;
}

KeptSides automatic_sides(const Scene& scene) {
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 1);
  kept.back.assign(scene.polygons.size(), 1);
  const std::vector<Point> lamps = points_before_lamps(scene);
  Count count;
  for (const Solid& solid : closed_solids(scene)) {
    const auto held = static_cast<std::size_t>(
        std::count_if(lamps.begin(), lamps.end(), [&](const Point& lamp) { return holds(solid, lamp); }));
    const bool keep_inside = held > 0;
    const bool keep_outside = held == 0 || held < lamps.size();
    for (const PolygonIndex p : solid.polygons) {
      kept.front[p] = solid.fronts_face_inside ? keep_inside : keep_outside;
      kept.back[p] = solid.fronts_face_inside ? keep_outside : keep_inside;
    }
    count.dark += !keep_inside;
    count.outside += !keep_outside;
    if (keep_inside && !solid.fronts_face_inside && count.outward++ == 0) {
      count.first_outward_line = scene.polygons[solid.polygons[0]].line;
    }
  }
  kept.notes = notes_on(count);
  return kept;
}

}  // namespace

KeptSides kept_sides(const Scene& scene, Sides sides) {
  if (sides == Sides::automatic) return automatic_sides(scene);
  KeptSides kept;
  kept.front.assign(scene.polygons.size(), 1);
  kept.back.assign(scene.polygons.size(), sides == Sides::both ? 1 : 0);
  kept.emit_from_back = sides == Sides::both;
  if (kept.emit_from_back) kept.notes.push_back("lamps emit from both sides: twice the flux of their front sides");
  return kept;
}

}  // namespace patchlight
