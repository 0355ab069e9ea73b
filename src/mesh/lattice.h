#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace patchlight {

using FlatPoint = Eigen::Vector2d;

/// The points of an equilateral lattice that lie in a polygon of the plane, not nearer than `margin` to its edges. One
/// row along x at a time; the lattice contains the origin.
std::vector<std::vector<FlatPoint>> lattice_rows(std::span<const FlatPoint> polygon, double spacing, double margin);

}  // namespace patchlight
