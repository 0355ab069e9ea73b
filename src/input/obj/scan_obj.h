#pragma once

#include "patchlight/base/geometry.h"

#include "input/left_out.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// A name in an OBJ file and the line it stands on.
struct ObjName {
  std::string name;
  std::uint32_t line = 0;
};

/// Stands for a face before any usemtl.
inline constexpr std::uint32_t no_material = ~std::uint32_t{0};

/// Stands for a corner that names no picture point, or none that is there.
inline constexpr std::uint32_t no_place = ~std::uint32_t{0};

/// What is known of a face from its line and those above it.
struct ObjFace {
  std::uint32_t line = 0;
  std::uint32_t material = no_material;  ///< index into ObjScan::materials
  std::vector<std::uint32_t> corners;    ///< from 0, when there are more than tinyobjloader can count; else empty
  std::size_t first_place = 0;           ///< index into ObjScan::places of its first corner
};

/// An OBJ file whose numbers and indices are known to be good.
struct ObjScan {
  std::vector<Point> vertices;                  ///< in model units
  std::vector<ObjFace> faces;                   ///< in the file's order
  std::vector<Eigen::Vector2d> picture_points;  ///< the vt statements, v from the bottom
  std::vector<std::uint32_t> places;            ///< per corner of each face: a picture point, or no_place
  std::vector<ObjName> materials;               ///< the names after usemtl, each once
  std::vector<ObjName> libraries;               ///< what follows each mtllib
  std::string geometry;  ///< the v, f, g and o statements alone, one per line; faces with vertices only, and
                         ///< with the first three alone where ObjFace::corners has them all
  LeftOut left_out;      ///< faces with fewer than 3 corners, lines, points and free-form surfaces
  std::size_t colored_vertices = 0;  ///< v statements with a colour after the coordinates
};

/// Checks the statements of an OBJ file that tinyobjloader takes on trust, and records where they stand.
/// \throws InputError naming `file` and the line: a coordinate that is not a finite number, a corner that names no
/// vertex.
ObjScan scan_obj(std::string_view text, const std::string& file);

}  // namespace patchlight
