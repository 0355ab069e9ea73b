#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

// Scenes of one band. Polygons have vertices of their own; repair() joins them.
namespace patchlight::validation {

using Outline = std::vector<Point>;

/// A scene without polygons. Its materials are 0, with this reflectance and exitance, and 1, a black lamp of 1 W/m^2.
Scene empty_scene(double reflectance = 0.5, double exitance = 0);

/// The scene with one more polygon, facing the side from which its corners run counter-clockwise.
Scene with_polygon(Scene scene, const Outline& corners, std::uint32_t group, MaterialIndex material = 0);

/// The same polygon facing the other way.
Outline turned(Outline corners);

/// A rectangle, counter-clockwise seen from where u x v points.
Outline rectangle(const Point& corner, const Vector& u, const Vector& v);

/// A regular polygon around (0, 0, z) in the circle of this radius, facing up.
Outline regular_polygon(int corners, double radius, double z);

/// The walls of an upright regular prism in the cylinder of this radius, from z = 0 to `height`, facing outward.
std::vector<Outline> prism_walls(int sides, double radius, double height);

/// A polyhedron in the sphere around the origin: each of an octahedron's faces, whose edges are halved so many times,
/// pushed outward. 8 * 4^halvings triangles that face outward, octant by octant: x, y and z positive first and all
/// negative last.
std::vector<Outline> sphere_triangles(int halvings, double radius);

/// The six walls of the unit cube, facing inward: the floor first, the ceiling second.
std::vector<Outline> cube_walls();

}  // namespace patchlight::validation
