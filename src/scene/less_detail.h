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

/// The scene without details smaller than `detail` meters. A shell of opaque faces without a lamp, see shells_of(),
/// becomes
/// - nothing, when it fits into a cube of that size;
/// - a box of six faces in its place, when the shell is closed, without a hole through it, not thicker than 1 m, and
///   has more faces; when no vertex lies farther than `detail` inside of the box, none of the box's sides is left free
///   by more than a rim of that width, and nothing else is inside. Its material is that of the faces, or a new one with
///   their mean reflectance.
/// A note gives the shares of the area that went and that is boxes. Pure; O(n log n) for n corners.
Scene with_less_detail(Scene scene, double detail);

}  // namespace patchlight
