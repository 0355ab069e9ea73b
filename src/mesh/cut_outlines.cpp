#include "mesh/cut_outlines.h"

#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace patchlight {
namespace {

using EdgeKey = std::array<double, 6>;

// The ends of an edge, that which comes first first.
EdgeKey key_of(const std::vector<Point>& corners, std::size_t edge) {
  const Point* a = &corners[edge];
  const Point* b = &corners[(edge + 1) % corners.size()];
  if (comes_before(*b, *a)) std::swap(a, b);
  return {a->x(), a->y(), a->z(), b->x(), b->y(), b->z()};
}

struct MarksOfEdge {
  Vector normal;
  double near;
  std::vector<double> places;  // in order
};

// Per edge with marks, those of every polygon that has it, with one in place of several at one place.
using MarksByEdge = std::map<EdgeKey, std::vector<MarksOfEdge>>;

double length_of(const EdgeKey& key) { return Point(key[3] - key[0], key[4] - key[1], key[5] - key[2]).norm(); }

MarksByEdge marks_by_edge(const std::vector<CutPolygon>& polygons) {
  MarksByEdge all;
  for (const CutPolygon& polygon : polygons) {
    for (const Mark& mark : polygon.marks) {
      std::vector<MarksOfEdge>& of_edge = all[key_of(polygon.corners, mark.edge)];
      const auto same = std::find_if(of_edge.begin(), of_edge.end(), [&](const MarksOfEdge& other) {
        return std::abs(other.normal.dot(polygon.normal)) >= smooth_cosine;
      });
      (same == of_edge.end() ? of_edge.emplace_back(MarksOfEdge{polygon.normal, polygon.near, {}}) : *same)
          .places.push_back(mark.t);
    }
  }
  for (auto& [key, of_edge] : all) {
    const double step = of_edge.front().near / length_of(key);
    for (MarksOfEdge& marks : of_edge) {
      std::sort(marks.places.begin(), marks.places.end());
      std::vector<double> apart;
      for (const double t : marks.places) {
        if (apart.empty() || t - apart.back() > step) apart.push_back(t);
      }
      marks.places = std::move(apart);
    }
  }
  return all;
}

// The places on an edge of a polygon where lines of it or of its neighbour end.
std::vector<double> places_on(const MarksByEdge& all, const CutPolygon& polygon, std::size_t edge) {
  const auto found = all.find(key_of(polygon.corners, edge));
  if (found == all.end()) return {};
  for (const MarksOfEdge& marks : found->second) {
    if (std::abs(marks.normal.dot(polygon.normal)) >= smooth_cosine) return marks.places;
  }
  return {};
}

// The same bits from both polygons that have the edge.
Point marked_point(const EdgeKey& key, double t) {
  const Point from(key[0], key[1], key[2]);
  return from + t * (Point(key[3], key[4], key[5]) - from);
}

Outline outline_with_marks(const CutPolygon& polygon, const MarksByEdge& all, double max_edge) {
  if (all.empty() && polygon.lines.empty()) return make_outline(polygon.corners, polygon.normal, max_edge);
  std::vector<Point> corners;
  for (std::size_t k = 0; k < polygon.corners.size(); ++k) {
    corners.push_back(polygon.corners[k]);
    std::vector<double> places = places_on(all, polygon, k);
    const EdgeKey key = places.empty() ? EdgeKey{} : key_of(polygon.corners, k);
    if (comes_before(polygon.corners[(k + 1) % polygon.corners.size()], polygon.corners[k]))
      std::reverse(places.begin(), places.end());
    for (const double t : places) corners.push_back(marked_point(key, t));
  }
  Outline outline = make_outline(std::move(corners), polygon.normal, max_edge);

  const auto point_at = [&](const LineEnd& end) -> Point {
    if (!end.mark) return end.point;
    const std::vector<double> places = places_on(all, polygon, end.mark->edge);
    const double nearest = *std::min_element(places.begin(), places.end(), [&](double a, double b) {
      return std::abs(a - end.mark->t) < std::abs(b - end.mark->t);
    });
    return marked_point(key_of(polygon.corners, end.mark->edge), nearest);
  };
  for (const auto& [from, to] : polygon.lines) outline.lines.push_back({point_at(from), point_at(to)});
  std::erase_if(outline.lines, [](const auto& line) { return line[0] == line[1]; });
  return outline;
}

// Polygons that share an edge share its points: as many parts as the finest of them takes.
std::vector<Outline> with_shared_parts(std::vector<Outline> outlines) {
  std::map<EdgeKey, std::uint32_t> parts;
  for (const Outline& outline : outlines)
    for (std::size_t k = 0; k < outline.corners.size(); ++k) {
      std::uint32_t& finest = parts[key_of(outline.corners, k)];
      finest = std::max(finest, outline.parts[k]);
    }
  for (Outline& outline : outlines)
    for (std::size_t k = 0; k < outline.corners.size(); ++k) outline.parts[k] = parts.at(key_of(outline.corners, k));
  return outlines;
}

}  // namespace

std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges,
                                  std::span<const std::uint8_t> is_needed) {
  const MarksByEdge marks = marks_by_edge(polygons);
  std::vector<Outline> outlines(polygons.size());
  parallel_for(polygons.size(), [&](std::size_t p) {
    if (is_needed[p]) outlines[p] = outline_with_marks(polygons[p], marks, edges.on(p));
  });
  return edges.coarsest.empty() ? outlines : with_shared_parts(std::move(outlines));
}

std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges) {
  return cut_outlines(polygons, edges, std::vector<std::uint8_t>(polygons.size(), 1));
}

}  // namespace patchlight
