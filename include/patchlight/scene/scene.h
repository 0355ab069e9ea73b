#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/material.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

using PolygonIndex = std::uint32_t;

/// Stands for "no polygon".
inline constexpr PolygonIndex no_polygon = ~PolygonIndex{0};

/// The two sides of a polygon: from the front its corners run counter-clockwise.
enum class Side : std::uint8_t { front, back };

/// A planar polygon of the model, without holes, not necessarily convex.
struct Polygon {
  std::vector<std::uint32_t> corners;  ///< indices into Scene::vertices, at least three
  MaterialIndex material = 0;
  std::uint32_t group = 0;  ///< index into Scene::groups
  std::uint32_t line = 0;   ///< in the model file, from 1; 0 if unknown
  std::uint32_t file = 0;   ///< index into Scene::files
};

/// Where a picture is taken from.
struct Camera {
  Point eye;
  Point target;
  double vertical_field_of_view = 50;  ///< degrees
};

/// A model: polygons with materials, in metres. Lamps are polygons whose material has an exitance.
struct Scene {
  std::vector<Point> vertices;  ///< metres
  std::vector<Polygon> polygons;
  std::vector<Material> materials;
  std::vector<std::string> groups;  ///< names of objects and groups
  std::string file;                 ///< the model file's name, for messages
  std::vector<std::string> files;   ///< the files the polygons come from; empty when `file` is the only one
  std::string sha256;               ///< of the model file and its material files, hexadecimal
  double metres_per_unit = 1;       ///< length of one unit of the model file
  Vector up = Vector::UnitZ();
  std::vector<std::string> notes;  ///< what the file holds that is not simulated, and other remarks
};

/// The corner points of a polygon.
std::vector<Point> corner_points(const Scene& scene, PolygonIndex polygon);

/// The unit normal of a polygon's front side; zero for a polygon without area.
Vector front_normal(const Scene& scene, PolygonIndex polygon);

/// True when the polygon's material emits in any band.
bool is_lamp(const Scene& scene, PolygonIndex polygon);

/// Bounds of all vertices that polygons use.
Box bounds(const Scene& scene);

/// Checks what every later step relies on: finite vertices, corners in range, at least one polygon, planar polygons
/// with area, reflectance in [0, 1], exitance finite and not negative. \throws InputError naming the file and line, or
/// the material.
void check(const Scene& scene);

}  // namespace patchlight
