#pragma once

#include "patchlight/base/field.h"
#include "patchlight/base/geometry.h"
#include "patchlight/views/views.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace patchlight {

/// What a page draws of a solved surface. A row has the values of one patch, or the means over all patches of one side
/// of a polygon, where there are too many.
struct DrawnFaces {
  std::vector<Point> vertices;                        ///< metres
  std::vector<std::array<std::uint8_t, 3>> colours;   ///< per vertex: as it looks, sRGB
  std::vector<std::array<std::uint32_t, 4>> corners;  ///< per face, counter-clockwise; a triangle repeats its last
  std::vector<std::uint32_t> row;                     ///< per face
  std::vector<PatchRange> patches;                    ///< per row
  std::size_t left_out = 0;                           ///< patches of the smallest faces, which are not drawn
  std::size_t covered = 0;                            ///< patches that lie wholly under other faces: not drawn either
};

/// The faces of a surface that can be seen, at most `most` of them: patches, and where these are too many, whole sides
/// of polygons in place of those patches that differ least from their mean, at last without the smallest. Colours are
/// those of `exposure`. O(n log n).
DrawnFaces drawn_faces(const SolvedSurface& surface, double exposure, std::size_t most);

}  // namespace patchlight
