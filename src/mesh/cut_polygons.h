#pragma once

#include "patchlight/scene/contact_lines.h"

#include "mesh/outline.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// A place on the edge after a corner, from 0 to 1 from that end which comes first in comes_before().
struct Mark {
  std::size_t edge;
  double t;
};

/// An end of a line: a corner, a mark, or a point inside.
struct LineEnd {
  std::optional<Mark> mark;
  Point point;  ///< where there is no mark
};

/// A polygon with the lines inside it, cut where they meet, and what ends on its outline.
struct CutPolygon {
  std::vector<Point> corners;
  Vector normal;    ///< unit, of the front
  double near = 0;  ///< metres: marks that are no farther from each other are one
  std::vector<Mark> marks;
  std::vector<std::array<LineEnd, 2>> lines;
};

/// How fine lines of contact are for patches with edges of `max_edge` at most, metres: ContactLines::size divided by a
/// power of two, so that patches of about one size follow the same lines; no more than `max_edge` and
/// ContactLines::detail.
double followed_detail(const ContactLines& contacts, double max_edge);

/// Every polygon with the lines of contact that matter to patches with edges of its length at most: those with a gap of
/// less than a quarter of the detail that is followed, and of what ends there. Lines that bend have corners only as far
/// as a hundredth of the detail shows them, and what is smaller than sixteen times that is left out. On both sides of
/// long edges that are very close there are lines in one and three widths of the gap. Quadratic in the lines of one
/// polygon.
std::vector<CutPolygon> cut_polygons(const Scene& scene, const LooseCorners& loose, const ContactLines& contacts,
                                     const PatchEdges& edges);

/// What cut_polygons() gives, from what it gave for another edge: those without loose corners stay as they are, and
/// where that edge had the same followed_detail() those with lines as well.
std::vector<CutPolygon> cut_again(std::vector<CutPolygon> polygons, const Scene& scene, const LooseCorners& loose,
                                  const ContactLines& contacts, const PatchEdges& edges, bool same_detail);

/// The outlines of polygons with lines. Where a line ends on an outline there is a corner, also of a neighbour in about
/// the same plane that shares the edge. Those that are not needed stay empty.
std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges,
                                  std::span<const std::uint8_t> is_needed);
std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges);

}  // namespace patchlight
