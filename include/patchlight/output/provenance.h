#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <vector>

namespace patchlight {

/// The version of this library, "major.minor.patch".
const char* version();

/// Where a result comes from.
struct Provenance {
  std::string command_line;
  double exposure = 1;       ///< of the colours beside the values
  std::string scene_hash{};  ///< of faces, materials and lights; empty: not recorded, and pictures of the result cannot
                             ///< be taken later
  std::vector<std::string> changes{};  ///< what was done besides, which the command line does not say
};

}  // namespace patchlight
