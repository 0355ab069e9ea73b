#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

namespace patchlight {

using FlatPoint = Eigen::Vector2d;

/// A line between two points of a plane.
using FlatLine = std::array<FlatPoint, 2>;

/// Twice the area of the triangle from the origin to both points, positive when it turns left.
inline double wedge(const FlatPoint& a, const FlatPoint& b) { return a.x() * b.y() - a.y() * b.x(); }

/// From a point to the nearest one of a line.
FlatPoint to_line(const FlatPoint& point, const FlatLine& line);

/// The edges of a polygon; the first begins at its first corner.
std::vector<FlatLine> edges_of(std::span<const FlatPoint> polygon);

/// True when a ray along x from the point crosses an odd number of these edges. A seam counts twice.
bool is_inside(const FlatPoint& point, std::span<const FlatLine> edges);

/// The points of an equilateral lattice that lie in a polygon of the plane, not nearer than `margin` to its edges and
/// to lines inside it. One row along x at a time; the lattice contains the origin.
std::vector<std::vector<FlatPoint>> lattice_rows(std::span<const FlatPoint> polygon, std::span<const FlatLine> lines,
                                                 double spacing, double margin);

/// The same lines cut wherever they meet, each once: those that are nearer than the width of a square grid become one
/// (snap rounding; Hobby 1999). Their ends lie on the lines themselves but for rounding, or, where these cross at a
/// narrow angle, within that width of them. In the order of their ends. Nothing where lines_on_grid() gives nothing.
std::vector<FlatLine> noded_lines(std::span<const FlatLine> lines, double grid);

/// The same lines, each once, with fewer corners where they bend. No line moves by more than `tolerance`. Connected
/// groups smaller than `least_size` are left out.
std::vector<FlatLine> simplified_lines(std::span<const FlatLine> lines, double grid, double tolerance,
                                       double least_size);

/// The lines at a distance from these, which meet in their ends alone, to both sides of them, without the parts
/// whose middles are nearer to any. O(n^2).
std::vector<FlatLine> lines_beside(std::span<const FlatLine> lines, double grid, double distance);

}  // namespace patchlight
