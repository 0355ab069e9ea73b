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
  double near = 0;  ///< meters: marks no farther apart are merged
  std::vector<Mark> marks;
  std::vector<std::array<LineEnd, 2>> lines;
};

/// The resolution, in meters, of lines of contact for patches with edges of at most `max_edge`. It is
/// ContactLines::size divided by a power of two, so that patches of similar size follow the same lines. It does not
/// exceed `max_edge` or ContactLines::detail.
double followed_detail(const ContactLines& contacts, double max_edge);

/// Every polygon with the lines of contact that matter to patches with edges of at most this length. A line matters if
/// its gap is less than a quarter of the followed detail. Bent lines are simplified to a hundredth of the detail; lines
/// smaller than sixteen times that are left out. Beside long edges with a very small gap, there are lines at one and
/// three gap widths on both sides. Quadratic in the lines of one polygon.
std::vector<CutPolygon> cut_polygons(const Scene& scene, const LooseCorners& loose, const ContactLines& contacts,
                                     const PatchEdges& edges);

/// The result of cut_polygons() for other edges, reusing `polygons`. Polygons without loose corners stay unchanged, and
/// so do those with lines if followed_detail() is the same.
std::vector<CutPolygon> cut_again(std::vector<CutPolygon> polygons, const Scene& scene, const LooseCorners& loose,
                                  const ContactLines& contacts, const PatchEdges& edges, bool same_detail);

/// The outlines of polygons with lines. A line that ends on an outline adds a corner, also to a neighbor that shares
/// the edge in about the same plane. Outlines that are not needed stay empty.
std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges,
                                  std::span<const std::uint8_t> is_needed);
std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges);

}  // namespace patchlight
