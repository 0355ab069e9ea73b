#pragma once

#include "patchlight/scene/scene.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// An edge of one polygon only: two vertices of the scene in the order in which the polygon walks along it, turned back
/// where it is turned. Where vertices are welded the first of them stands for all.
struct RimEdge {
  PolygonIndex polygon = 0;
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

/// How the polygons of a scene hang together. A shell is a set of polygons connected by shared edges; vertices nearer
/// than weld_distance() are one.
struct Shells {
  std::vector<PolygonIndex> shell;     ///< per polygon: the first polygon of its shell
  std::vector<std::uint8_t> turned;    ///< per polygon: 1 when it is turned against most of the area it is connected to
  std::vector<std::uint8_t> closed;    ///< per polygon: 1 when each edge of its shell belongs to exactly two of its
                                       ///< polygons, which walk along it in opposite directions once those turned are
                                       ///< turned back
  std::vector<std::uint8_t> rimmed;    ///< per polygon: 1 when its shell would be closed but for edges of one polygon
  std::vector<RimEdge> rim;            ///< all of these edges
  std::vector<PolygonIndex> branched;  ///< the polygons at edges that three or more walk along
  std::size_t branched_edges = 0;
  std::size_t count = 0;         ///< of shells
  std::size_t closed_count = 0;  ///< of closed shells
};

/// O(n log n) for n corners.
Shells shells_of(const Scene& scene);

}  // namespace patchlight
