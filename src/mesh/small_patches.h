#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace patchlight {

/// The square of the longest edge of a patch, m^2.
inline double longest_edge_squared(const PatchCorners& corners) {
  const auto count = static_cast<std::size_t>(corners.count);
  double longest = 0;
  for (std::size_t k = 0; k < count; ++k)
    longest = std::max(longest, (corners.points[(k + 1) % count] - corners.points[k]).squaredNorm());
  return longest;
}

/// The mean of areas, m^2.
double mean_area(std::span<const double> areas);

/// The mean area of the patches, m^2.
double mean_area(const PatchMesh& mesh);

/// The area in m^2 below which a patch is small: a sixteenth of the mean. In models with fine parts most patches are,
/// and have together some thousandths of all area, so that less work on each of them saves much and costs little.
double small_area(const PatchMesh& mesh);

/// The mesh without the patches for which `is_left_out` is not 0; it has an entry for each patch. Patches and vertices
/// stay in order; vertices that no patch has any more go as well.
PatchMesh without_patches(const PatchMesh& mesh, std::span<const std::uint8_t> is_left_out);

/// Part 0 to 3 of a patch that is cut by the middles of its edges, in the order of refine().
PatchCorners quarter_of(const PatchCorners& patch, int quarter);

/// The quarter of a patch, a convex one with this normal, that contains a point of its plane; of points on a cut, or
/// slightly outside of the patch, one of those beside them.
int quarter_at(const PatchCorners& patch, const Vector& normal, const Point& point);

}  // namespace patchlight
