#pragma once

#include "mesh/cut_polygons.h"
#include "mesh/outline.h"
#include "mesh/patch_edges.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// The outlines of polygons with lines. Where a line ends on an outline there is a corner, also of a neighbour in about
/// the same plane that shares the edge. Those that are not needed stay empty.
std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges,
                                  std::span<const std::uint8_t> is_needed);
std::vector<Outline> cut_outlines(const std::vector<CutPolygon>& polygons, const PatchEdges& edges);

}  // namespace patchlight
