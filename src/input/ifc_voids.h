#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace patchlight {

/// The text of an IFC file in STEP format in which profiles with voids have become closed ones.
struct JoinedVoids {
  std::string text;
  std::size_t joined = 0;  ///< profiles whose voids were joined to their outline
  std::size_t left = 0;    ///< profiles with a curve that is no polyline, or without a seam: they stay as they are
};

/// assimp reads IfcArbitraryProfileDefWithVoids without its voids, so that the frame of a window becomes a board. Here
/// each becomes an IfcArbitraryClosedProfileDef whose outline walks to every void and back along a seam, as polygons of
/// a scene do. O(n) in the length of the text; the square of the corners of a profile.
JoinedVoids with_joined_voids(std::string_view text);

}  // namespace patchlight
