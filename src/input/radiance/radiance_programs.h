#pragma once

#include "patchlight/base/geometry.h"

#include "input/radiance/radiance_text.h"

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The surfaces that Radiance's genbox prints for the words behind its name: "MATERIAL NAME X Y Z" and the options
/// -b BEVEL, -r RADIUS and -i (fronts inward). The box reaches from the origin to (X, Y, Z). \throws InputError at
/// `where`: an option is not known, a word is missing, or a length does not fit.
std::vector<RadiancePrimitive> radiance_genbox(std::span<const std::string> arguments, const std::string& where);

/// The transformation that Radiance's xform applies to the surfaces of files.
struct RadianceXform {
  std::vector<Eigen::Affine3d> copies = {
      Eigen::Affine3d::Identity()};  ///< where each copy stands; lengths as in the file
  std::string modifier;              ///< that surfaces get instead of their own; empty: none
  std::string name;                  ///< put before their names; empty: none
  bool turns_fronts = false;         ///< what was the front is the back
  std::vector<std::string> files;    ///< what stands behind the options
};

/// The words behind "xform": options -t -rx -ry -rz -s -sx -sy -sz -mx -my -mz, repeated by -i, copied by -a (more than
/// one for arrays of arrays) or by the lines of a file (-f), and -n -m -I -c -e -l. `words_of` gives the words of each
/// line of a file. \throws InputError at `where`: an option is not known, or lacks a number, or there are more than
/// 100,000 copies.
RadianceXform radiance_xform(std::span<const std::string> arguments, const std::string& where,
                             const std::function<std::vector<std::vector<std::string>>(const std::string&)>& words_of);

}  // namespace patchlight
