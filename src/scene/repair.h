#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// Makes a scene that a reader has put together fit for meshing. Defects of its shape are fixed or left out, and
/// reported in Scene::diagnostics. In this order:
/// - vertices at one place become one (see weld_distance() in scene/extent.h);
/// - corners that repeat the one before, and spikes out and back, are left out;
/// - faces without area, narrower than vertices are welded, are left out;
/// - faces whose outline crosses itself are cut at the crossings; a seam to a hole, walked along both ways, is none;
/// - faces that are not planar are cut into triangles, as are those that do not come out right otherwise;
/// - of faces with the same corners the first stays; one that faces the other way gives it its Polygon::back_material;
/// - an opaque face under a clear one of the same plane, or with the same corners, is opened there;
/// - of the two faces of a solid pane the second becomes clear in full;
/// - faces turned against the majority of those they are connected to and edges of three faces or more are counted.
/// Polygon::face is set to the index in the given scene, so that every polygon names the face it comes from.
/// Pure; O(n log n) for n corners. \throws InputError when a corner names no vertex or a vertex is not finite.
Scene repair(Scene scene);

}  // namespace patchlight
