#pragma once

#include "mesh/outline.h"

#include <cstddef>
#include <vector>

namespace patchlight {

/// The patches of one polygon: a grid of quadrilaterals or triangles where the outline allows it, else a Delaunay mesh,
/// see tessellate().
PolygonMesh mesh_polygon(const Outline& outline, double max_edge);

/// How many patches that has.
std::size_t count_patches(const Outline& outline, double max_edge);

/// The longest edge of each of them, metres.
std::vector<double> longest_edges(const Outline& outline, double max_edge);

}  // namespace patchlight
