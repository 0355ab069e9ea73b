#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// A part of the plane of some faces that none of them fills.
struct Hole {
  PolygonIndex plane = 0;                  ///< the largest of the faces in its plane
  std::vector<std::vector<Point>> pieces;  ///< convex, counter-clockwise around one normal of the plane
};

/// Parts of the planes of a scene's faces that none of the faces in that plane fills, though they lie within the convex
/// hull of these and of corners of other faces near by that lie in the plane: holes in walls, what is left free for
/// doors, slits between a wall and the ceiling above it; but also what lies beside an L-shaped floor. Pieces narrower
/// than weld_distance() are left out. Cuts the largest faces first, for some tenths of a second at most; of planes with
/// very many faces nothing is found. O(n log n) for n polygons, expected.
std::vector<Hole> holes_between_faces(const Scene& scene);

}  // namespace patchlight
