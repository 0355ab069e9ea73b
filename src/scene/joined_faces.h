#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with coplanar faces of one object and material as one polygon where they share edges, so that a wall in
/// triangles is meshed like a wall. Edges at which a third face stands stay. The polygon takes the place, line and face
/// of the first; a hole is joined to the outline by a seam. Corners at which all polygons go straight on are left out.
/// Faces stay apart where that would give a polygon of over 2,000 corners, or one that is not planar and simple.
/// Groups of faces with four corners stay as well: they are a mesh already.
/// Normals are kept within 1e-4 radians. Pure; O(n log n) for n corners.
Scene with_joined_faces(Scene scene);

}  // namespace patchlight
