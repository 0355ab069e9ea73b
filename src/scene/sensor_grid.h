#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"

#include <array>
#include <span>
#include <vector>

namespace patchlight {

/// The most sensors that a grid may have.
inline constexpr double most_sensors = 1e6;

/// The number of cells of at most `spacing` along a length, at least one. A length that rounding makes a little longer
/// than a whole number of cells counts as that.
double cells_along(double length, double spacing);

/// A grid over a parallelogram from `corner` along two edges: cells of at most `spacing` each way, in meters, with a
/// sensor in the middle of each that faces edges[0] x edges[1]. Rows go along edges[0]. At most most_sensors cells.
SensorGroup rectangle_grid(const Point& corner, const std::array<Vector, 2>& edges, double spacing);

/// Level polygons at one height, in meters; they may share edges.
struct Floor {
  std::vector<std::vector<Point>> outlines;
  Vector up = Vector::UnitZ();
};

/// The lowest level faces among those given, or of a slab, which has an underside, its top. No outline when none is
/// level.
Floor floor_of(const std::vector<std::vector<Point>>& faces, const Vector& up);

/// The floor of a body of air: its level faces with the air above them, at the height with the largest area of such
/// faces. For faces that enclose no air, floor_of().
Floor floor_of_room(const std::vector<std::vector<Point>>& faces, const Vector& up);

/// The corner points of some polygons of a scene.
std::vector<std::vector<Point>> outlines_of(const Scene& scene, std::span<const PolygonIndex> polygons);

/// m^2
double area_of(const Floor& floor);

/// The rectangle around a floor, along the direction that most of its rim has, `height` meters above it: a corner and
/// the two edges from it.
std::array<Vector, 3> rectangle_over(const Floor& floor, double height);

/// How a grid lies over a floor, meters.
struct GridSize {
  double spacing = 0;     ///< cells have at most this spacing
  double from_walls = 0;  ///< a strip along the rim without cells
};

/// The largest cells that EN 12464-1 allows for an area with sides of these lengths, meters: p = 0.2 * 5^log10(d), at
/// most 10 m, where d is the longer side, or the shorter one of an area at least twice as long as wide.
double standard_spacing(double side, double other_side);

/// The grid of EN 12464-1 over a floor: standard_spacing() of the rectangle around it, and a strip of 0.5 m. Narrow
/// floors have smaller ones: the strip takes at most half of the widest place, and a row of cells fits into the rest.
GridSize standard_grid(const Floor& floor);

/// The number of cells of the grid over the rectangle around a floor.
double most_cells(const Floor& floor, const GridSize& size);

/// A grid over a floor, facing up: cells over rectangle_over() less the strip along its edges, without those whose
/// middle lies beside the floor or in the strip along its rim.
SensorGroup floor_grid(const Floor& floor, double height, const GridSize& size);

/// Area of the cells of a grid, m^2.
double area_of(const SensorGroup& grid);

}  // namespace patchlight
