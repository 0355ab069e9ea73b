#pragma once

#include "input/mitsuba_file.h"
#include "input/round_shapes.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace patchlight {

/// Meshes of files, each read once.
struct MitsubaMeshes {
  std::filesystem::path confine;  ///< the folder in which they must lie; empty for any
  std::map<std::string, std::optional<FacetedShape>> by_file;
  std::vector<std::filesystem::path> files;  ///< that were read
  std::vector<std::string> digests;          ///< of the same
  std::vector<Problem> losses;               ///< parts that are left out
};

/// The kinds of shapes that can be read: obj, ply, rectangle, cube, sphere, disk and cylinder.
bool is_mitsuba_shape(const std::string& kind);

/// The faces of a shape before its transformation. Nothing when the file of a mesh is not there. \throws InputError
/// naming the line, or the mesh's file.
std::optional<FacetedShape> mitsuba_shape(const MitsubaFile& file, const pugi::xml_node& shape, MitsubaMeshes& meshes);

}  // namespace patchlight
