#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sensor.h"

#include <array>
#include <span>

namespace patchlight {

/// The most sensors that a grid may have.
inline constexpr double most_sensors = 1e6;

/// The number of cells of at most `spacing` along a length, at least one. A length that rounding makes a little longer
/// than a whole number of cells counts as that.
double cells_along(double length, double spacing);

/// A grid over a parallelogram from `corner` along two edges: cells of at most `spacing` each way, in metres, with a
/// sensor in the middle of each that faces edges[0] x edges[1]. Rows go along edges[0]. At most most_sensors cells.
SensorGroup rectangle_grid(const Point& corner, const std::array<Vector, 2>& edges, double spacing);

/// The level polygons at the lowest height among those given: a floor. Empty when none is level.
std::vector<PolygonIndex> floor_of(const Scene& scene, std::span<const PolygonIndex> polygons);

/// The rectangle around a floor, along its longest edge, `height` metres above it: a corner and the two edges from it.
std::array<Vector, 3> rectangle_over(const Scene& scene, std::span<const PolygonIndex> floor, double height);

/// A grid over a floor, facing up: that of rectangle_over(), without the cells whose middle lies beside the floor.
SensorGroup floor_grid(const Scene& scene, std::span<const PolygonIndex> floor, double height, double spacing);

}  // namespace patchlight
