#include "patchlight/scene/contact_lines.h"

#include "base/parallel.h"
#include "scene/extent.h"
#include "scene/face_tree.h"
#include "scene/triangulate.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace patchlight {
namespace {

// An edge between two vertices with one of the polygons that have it.
struct SharedEdge {
  std::uint32_t low, high;
  PolygonIndex polygon;

  auto ends() const { return std::tuple(low, high); }
};

std::vector<SharedEdge> edges_of(const Scene& scene) {
  std::vector<SharedEdge> edges;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const auto& corners = scene.polygons[p].corners;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const auto [low, high] = std::minmax(corners[k], corners[(k + 1) % corners.size()]);
      edges.push_back({low, high, p});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const SharedEdge& a, const SharedEdge& b) {
    return std::tuple(a.ends(), a.polygon) < std::tuple(b.ends(), b.polygon);
  });
  return edges;
}

// Lines with the polygons that they are on.
using LinesOnFaces = std::vector<std::pair<PolygonIndex, ContactLine>>;

// A polygon on which lines are looked for.
struct Ground {
  PolygonIndex polygon;
  std::vector<Point> corners;
  Vector normal;
  double reach;  // meters
  bool convex;
  bool front, back;  // which sides are kept

  double height(const Point& point) const { return normal.dot(point - corners[0]); }
  Point foot(const Point& point) const { return point - height(point) * normal; }
};

// The way into a face from its edge, seen along the ground's normal and across the edge: from -1 to 1.
double way_in(const Ground& ground, const FlatFace& face, const Point& from, const Point& to) {
  const Vector inward = face.normal.cross(to - from).normalized();
  return inward.dot(ground.normal.cross(to - from).normalized());
}

struct ContactSearch {
  const Scene& scene;
  const KeptSides& kept;
  FaceTree tree;
  std::vector<SharedEdge> edges;
  const std::vector<std::uint8_t>& is_bent;
  double touch;        // meters
  double largest_gap;  // meters

  Ground ground_of(PolygonIndex polygon) const {
    std::vector<Point> corners = corner_points(scene, polygon);
    const double reach = std::min(largest_gap, 0.1 * std::sqrt(tree.face(polygon).area));
    const bool convex = patchlight::is_convex(corners);
    return {polygon, std::move(corners),       tree.face(polygon).normal, reach,
            convex,  kept.front[polygon] != 0, kept.back[polygon] != 0};
  }

  // True if another face continues this one beyond the edge after this corner: then no shadow ends there. Light does
  // not pass below an edge that touches the ground, unless both faces lie on it.
  bool goes_on(const Ground& ground, PolygonIndex face, std::size_t corner, bool touches) const {
    const auto& corners = scene.polygons[face].corners;
    const auto [low, high] = std::minmax(corners[corner], corners[(corner + 1) % corners.size()]);
    const auto range = std::equal_range(edges.begin(), edges.end(), SharedEdge{low, high, 0},
                                        [](const auto& a, const auto& b) { return a.ends() < b.ends(); });
    if (range.second - range.first != 2) return false;
    const PolygonIndex other = range.first->polygon == face ? (range.first + 1)->polygon : range.first->polygon;
    if (other == face || other == ground.polygon) return false;
    const auto is_flat_on = [&](PolygonIndex one) {
      return std::all_of(scene.polygons[one].corners.begin(), scene.polygons[one].corners.end(),
                         [&](std::uint32_t v) { return std::abs(ground.height(scene.vertices[v])) <= touch; });
    };
    if (touches && !(is_flat_on(face) && is_flat_on(other))) return false;
    const auto& others = scene.polygons[other].corners;
    const auto place = std::find(others.begin(), others.end(), corners[corner]);
    const auto at = static_cast<std::size_t>(place - others.begin());
    const bool same_way = others[(at + 1) % others.size()] == corners[(corner + 1) % corners.size()];
    const Point& from = scene.vertices[corners[corner]];
    const Point& to = scene.vertices[corners[(corner + 1) % corners.size()]];
    const double one = way_in(ground, tree.face(face), from, to);
    const double two = (same_way ? 1 : -1) * way_in(ground, tree.face(other), from, to);
    // Neither face may rise too steeply there.
    return std::min(std::abs(one), std::abs(two)) > 0.1 && one * two < 0;
  }

  bool is_along_outline(const Ground& ground, const ContactLine& line) const {
    const std::size_t n = ground.corners.size();
    for (std::size_t k = 0; k < n; ++k) {
      const Point& from = ground.corners[k];
      const Point& to = ground.corners[(k + 1) % n];
      if (from == to) continue;
      if (squared_distance(line.from, from, to) <= touch * touch &&
          squared_distance(line.to, from, to) <= touch * touch)
        return true;
    }
    return false;
  }

  // The part of a line that lies on a convex polygon, if any; of others the line itself.
  std::optional<ContactLine> inside(const Ground& ground, ContactLine line) const {
    const std::size_t n = ground.corners.size();
    for (std::size_t k = 0; ground.convex && k < n; ++k) {
      const Vector inward = ground.normal.cross(ground.corners[(k + 1) % n] - ground.corners[k]);
      const double from = inward.dot(line.from - ground.corners[k]);
      const double to = inward.dot(line.to - ground.corners[k]);
      if (from <= 0 && to <= 0) return std::nullopt;
      const Point cut = line.from + from / (from - to) * (line.to - line.from);
      if (from < 0) line.from = cut;
      if (to < 0) line.to = cut;
    }
    if ((line.to - line.from).norm() <= touch || is_along_outline(ground, line)) return std::nullopt;
    return line;
  }

  // Edges of a face on the ground or close before it. Where an edge ends close before the ground, the light on the face
  // changes along it as well.
  void add_edges(const Ground& ground, PolygonIndex face, LinesOnFaces& lines) const {
    const std::vector<Point> corners = corner_points(scene, face);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point& from = corners[k];
      const Point& to = corners[(k + 1) % corners.size()];
      const auto [low, high] = std::minmax({ground.height(from), ground.height(to)});
      const double gap = std::max(std::abs(low), std::abs(high));
      if (gap > ground.reach || (low < -touch && !ground.back) || (high > touch && !ground.front)) continue;
      const bool touches = gap <= touch;
      if (goes_on(ground, face, k, touches)) continue;
      const auto line = inside(ground, {ground.foot(from), ground.foot(to), touches ? 0 : gap});
      if (!line) continue;
      lines.emplace_back(ground.polygon, *line);
      if (!touches && (kept.front[face] != 0 || kept.back[face] != 0))
        lines.emplace_back(face, ContactLine{from, to, gap});
    }
  }

  // Where a face goes through the ground: its outline does so an even number of times, and every other stretch between
  // these places is inside.
  void add_crossing(const Ground& ground, PolygonIndex face, LinesOnFaces& lines) const {
    const std::vector<Point> corners = corner_points(scene, face);
    const Vector along = ground.normal.cross(tree.face(face).normal);
    std::vector<std::pair<double, Point>> places;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point& next = corners[(k + 1) % corners.size()];
      const double from = ground.height(corners[k]);
      const double to = ground.height(next);
      if ((from > touch) == (to > touch)) continue;
      const double t = std::clamp(from / (from - to), 0.0, 1.0);
      const Point place = ground.foot(corners[k] + t * (next - corners[k]));
      places.emplace_back(along.dot(place - ground.corners[0]), place);
    }
    std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t k = 0; k + 1 < places.size(); k += 2) {
      if (const auto line = inside(ground, {places[k].second, places[k + 1].second, 0}))
        lines.emplace_back(ground.polygon, *line);
    }
  }

  LinesOnFaces on(PolygonIndex polygon) const {
    const Ground ground = ground_of(polygon);
    if (!ground.front && !ground.back) return {};
    const double margin = std::max(ground.reach, touch);
    std::vector<PolygonIndex> near;
    tree.for_each(FaceQuery{.box = with_margin(tree.face(polygon).box, margin)}, [&](PolygonIndex face) {
      const Box& other = tree.face(face).box;
      const double half = ground.normal.cwiseAbs().dot(other.sizes()) / 2;
      if (face != polygon && is_bent[face] == 0 && std::abs(ground.height(other.center())) <= half + margin)
        near.push_back(face);
    });
    std::sort(near.begin(), near.end());

    LinesOnFaces lines;
    for (const PolygonIndex face : near) {
      double lowest = std::numeric_limits<double>::infinity();
      double highest = -lowest;
      for (const std::uint32_t corner : scene.polygons[face].corners) {
        lowest = std::min(lowest, ground.height(scene.vertices[corner]));
        highest = std::max(highest, ground.height(scene.vertices[corner]));
      }
      const bool before = highest > touch;
      const bool behind = lowest < -touch;
      if (lowest > ground.reach || highest < -ground.reach) continue;
      if ((before && !behind && !ground.front) || (behind && !before && !ground.back)) continue;
      add_edges(ground, face, lines);
      if (before && behind) add_crossing(ground, face, lines);
    }
    return lines;
  }
};

// The number of lines, estimated from some polygons. A large one on which all others stand, for example a floor, does
// not represent these.
double expected_lines(const ContactSearch& search, const std::vector<std::uint8_t>& is_bent) {
  constexpr std::size_t looked_at = 512;
  const std::size_t step = is_bent.size() / looked_at;
  if (step < 2) return 0;
  std::vector<std::size_t> found(looked_at, 0);
  parallel_for(looked_at, [&](std::size_t k) {
    if (is_bent[k * step] == 0)
      found[k] = std::min<std::size_t>(1000, search.on(static_cast<PolygonIndex>(k * step)).size());
  });
  return static_cast<double>(std::accumulate(found.begin(), found.end(), std::size_t{0}) * step);
}

}  // namespace

std::size_t number_of(const ContactLines& contacts) {
  std::size_t number = 0;
  for (const std::vector<ContactLine>& lines : contacts.on) number += lines.size();
  return number;
}

ContactLines find_contact_lines(const Scene& scene, const KeptSides& kept) {
  FaceTree tree = tree_of_faces(scene, FaceOrder::by_place);
  double area = 0;
  for (std::size_t p = 0; p < scene.polygons.size(); ++p) area += tree.face(p).area;
  const std::vector<std::uint8_t> is_bent = bent_faces(scene);
  const ContactSearch search{
      scene, kept, std::move(tree), edges_of(scene), is_bent, weld_distance(scene), 0.02 * std::sqrt(area)};
  ContactLines lines;
  // A damaged model has more, where faces cross anywhere: finding them takes minutes, and none is followed.
  lines.everywhere = expected_lines(search, is_bent) > 2e6;
  if (lines.everywhere) return lines;
  std::vector<LinesOnFaces> found(scene.polygons.size());
  parallel_for(found.size(), [&](std::size_t p) {
    if (is_bent[p] == 0) found[p] = search.on(static_cast<PolygonIndex>(p));
  });
  lines.size = std::sqrt(area);
  if (std::all_of(found.begin(), found.end(), [](const LinesOnFaces& some) { return some.empty(); })) return {};
  lines.on.resize(scene.polygons.size());
  for (const LinesOnFaces& some : found) {
    for (const auto& [polygon, line] : some) lines.on[polygon].push_back(line);
  }
  return lines;
}

}  // namespace patchlight
