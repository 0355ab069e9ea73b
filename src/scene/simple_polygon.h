#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patchlight {

/// The unit normal of the plane nearest to some points: along the vector area, or where a polygon crosses itself so
/// that this vanishes, the direction of least spread. Zero for points on a line.
Vector plane_normal(std::span<const Point> polygon);

/// True when all corners are within `width` of the straight line through the two that are farthest from each other, or
/// so for triangles and about so for others: when the polygon is narrower than that.
bool is_narrow(std::span<const Point> polygon, double width);

/// True when no corner is farther from the polygon's plane than 1e-5 of its perimeter.
bool is_planar(std::span<const Point> polygon);

/// True when two edges of the polygon cross each other, each in its inside. Touching is no crossing. O(n log n)
/// for most outlines, O(n^2) in the worst case.
bool crosses_itself(std::span<const Point> polygon);

/// Cuts a polygon at the points where it crosses itself into polygons that do not, all turned the way of the largest;
/// narrow ones are left out. Nothing when there are over 100 crossings.
std::vector<std::vector<Point>> cut_at_crossings(std::vector<Point> polygon, double width);

/// The parts of convex pieces of a plane beside a triangle in it, in convex pieces; narrow ones are left out.
std::vector<std::vector<Point>> beside(const std::vector<std::vector<Point>>& pieces,
                                       const std::array<Point, 3>& triangle, double width);

/// The polygon in triangles, provided that they cover it without turning over: none has negative area.
std::optional<std::vector<std::array<std::uint32_t, 3>>> proper_triangles(std::span<const Point> polygon);

/// The pieces of one polygon.
struct Pieces {
  std::vector<Polygon> polygons;         ///< simple and planar, with area
  std::vector<Point> new_vertices;       ///< numbered after those of the scene
  std::optional<DiagnosticCode> defect;  ///< zero_area, self_intersecting or non_planar; nothing when it stays whole
};

/// Cuts a polygon of the scene into polygons for the mesher. Pieces narrower than `width` are left out.
Pieces pieces_of(const Scene& scene, const Polygon& polygon, double width);

}  // namespace patchlight
