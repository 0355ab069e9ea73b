#pragma once

#include "patchlight/scene/scene.h"

#include <string>

namespace patchlight {

/// What one of assimp's formats carries.
struct AssimpFormat {
  std::string extension;   ///< without its dot, lower case: the only importer that is asked
  bool has_seams = false;  ///< extruded profiles walk along seams to their holes: pairs of walls on these are no faces
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< from assimp's axes to those of the file
  bool has_pictures = false;                           ///< of diffuse colours
};

/// Reads a model with assimp: all faces, in the order of the nodes, with the nodes' transformations. Coordinates pass
/// through single precision. Diffuse colours become reflectances, emissive colours radiances in W/(m^2 sr), an opacity
/// below 1 makes a pane. Fills vertices (metres), polygons, materials, maps into pictures, groups (names of the nodes),
/// file, metres_per_unit, notes, and where the format has pictures the inputs, as with_decoded_pictures() takes them.
/// May crash on damaged files: call it within read_isolated(). \throws InputError naming `file`.
Scene assimp_scene(const std::string& bytes, const std::string& file, const AssimpFormat& format,
                   double metres_per_unit);

}  // namespace patchlight
