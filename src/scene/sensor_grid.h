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

/// A grid over a parallelogram from `corner` along two edges: cells of at most `spacing` each way, in metres, with a
/// sensor in the middle of each that faces edges[0] x edges[1]. Rows go along edges[0]. At most most_sensors cells.
SensorGroup rectangle_grid(const Point& corner, const std::array<Vector, 2>& edges, double spacing);

/// Level polygons at one height, in metres; they may share edges.
struct Floor {
  std::vector<std::vector<Point>> outlines;
  Vector up = Vector::UnitZ();
};

/// The lowest level faces among those given, or of a slab, which has an underside, its top. No outline when none is
/// level.
Floor floor_of(const std::vector<std::vector<Point>>& faces, const Vector& up);

/// The corner points of some polygons of a scene.
std::vector<std::vector<Point>> outlines_of(const Scene& scene, std::span<const PolygonIndex> polygons);

/// m^2
double area_of(const Floor& floor);

/// The rectangle around a floor, along the direction that most of its rim has, `height` metres above it: a corner and
/// the two edges from it.
std::array<Vector, 3> rectangle_over(const Floor& floor, double height);

/// A grid over a floor, facing up: that of rectangle_over(), without the cells whose middle lies beside the floor or
/// nearer to its rim than `from_walls`, metres.
SensorGroup floor_grid(const Floor& floor, double height, double spacing, double from_walls);

}  // namespace patchlight
