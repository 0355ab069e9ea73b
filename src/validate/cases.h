// Scenes of one band. Polygons have vertices of their own; repair() joins them.
#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/transport/assemble.h"

#include "validate/validate.h"

#include <Eigen/Core>
#include <vector>

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

/// A scene repaired, checked and cut into patches, with its exchange areas before closure, summed by group.
struct GroupExchange {
  Eigen::MatrixXd exchange_area;  ///< m^2
  Eigen::MatrixXd error;  ///< m^2, bound on what quadrature and storage as float make of it; sampling not included
  Eigen::VectorXd area;   ///< m^2, of the groups
};

/// What a finer mesh yields; a coarser one with edges twice as long tells how far it is from the limit, as the error at
/// least halves from one to the next.
Measured refined(const Measured& coarse, const Measured& fine);

/// Rectangles opposed, at a right angle, and sharing an edge at other angles; elements and rectangles.
std::vector<ValidationCase> rectangle_cases();

/// Discs, spheres and cylinders, by polygons and polyhedra.
std::vector<ValidationCase> curved_cases();

/// Rooms solved as a whole.
std::vector<ValidationCase> solved_cases();

}  // namespace patchlight::validation
