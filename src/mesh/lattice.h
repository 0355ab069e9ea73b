#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace patchlight {

using FlatPoint = Eigen::Vector2d;

/// A line between two points of a plane.
using FlatLine = std::array<FlatPoint, 2>;

/// The points of an equilateral lattice that lie in a polygon of the plane, not nearer than `margin` to its edges and
/// to lines inside it. One row along x at a time; the lattice contains the origin.
std::vector<std::vector<FlatPoint>> lattice_rows(std::span<const FlatPoint> polygon, std::span<const FlatLine> lines,
                                                 double spacing, double margin);

}  // namespace patchlight
