#pragma once

#include "patchlight/base/geometry.h"

#include "input/radiance/radiance_text.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// The surfaces that Radiance's genbox prints for its arguments "MATERIAL NAME X Y Z" and the options -b BEVEL, -r
/// RADIUS and -i (fronts inward). The box extends from the origin to (X, Y, Z). \throws InputError at `where` for an
/// unknown option, a missing word or an invalid length.
std::vector<RadiancePrimitive> radiance_genbox(std::span<const std::string> arguments, const std::string& where);

/// The transformation of surfaces by Radiance's xform.
struct RadianceXform {
  std::vector<Eigen::Affine3d> copies = {
      Eigen::Affine3d::Identity()};  ///< placement of each copy, lengths as in the file
  std::string modifier;              ///< replaces the modifiers of surfaces; empty: none
  std::string name;                  ///< prefix of names; empty: none
  bool turns_fronts = false;         ///< swaps front and back
  std::vector<std::string> files;    ///< words after the options
};

/// Parses the arguments of xform: -t -rx -ry -rz -s -sx -sy -sz -mx -my -mz, and -n -m -I -c -e -l. The option -i
/// repeats, -a copies (several make nested arrays), -f copies by the lines of a file. `words_of` returns the words of
/// each line of a file. \throws InputError at `where` for an unknown option, a missing number, or more than 100,000
/// copies.
RadianceXform radiance_xform(std::span<const std::string> arguments, const std::string& where,
                             const std::function<std::vector<std::vector<std::string>>(const std::string&)>& words_of);

}  // namespace patchlight
