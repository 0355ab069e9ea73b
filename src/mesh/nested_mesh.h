#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace patchlight {

/// Per patch of a sheet the one on its other side that has the same corners; a patch itself where there is none, as on
/// all other polygons. Empty when the mesh has no sheets. O(n log n).
std::vector<PatchIndex> other_sides(const PatchMesh& mesh);

/// A mesh some patches of which are cut.
struct Refinement {
  PatchMesh mesh;
  std::vector<PatchIndex> parent;  ///< per patch: the patch of the mesh before that it is or lies in
};

/// Cuts the marked patches into four by the middles of their edges, and others so that neighbors differ by one level at
/// most. Both sides of sheets are cut alike. The four parts of a patch follow each other in its place; neighbors that
/// share an edge share its middle. `marked` has an entry for each patch.
Refinement refine(const PatchMesh& mesh, std::span<const std::uint8_t> marked);

/// Cuts every patch: patch i becomes the patches 4 i to 4 i + 3.
PatchMesh refine(const PatchMesh& mesh);

/// Patches and their larger parents. The difference between the two solutions estimates the error.
struct NestedMesh {
  PatchMesh parents;
  PatchMesh patches;
  std::vector<PatchIndex> parent;       ///< of each patch
  std::vector<PatchIndex> first_patch;  ///< per parent: its first patch; one more entry at the end

  PatchRange patches_of(PatchIndex of) const { return {first_patch[of], first_patch[of + 1]}; }
};

/// No limit on the edges of parents.
inline constexpr double any_edge = std::numeric_limits<double>::infinity();

/// Cuts every parent into four parts. A parent stays whole where its longest edge is below a quarter of the longest of
/// all, or of `usual_edge` if that is less, as on small faces of a model.
NestedMesh nest(PatchMesh parents, double usual_edge = any_edge);

/// The number of parts into which nest() cuts a parent, from its longest edge and the longest of all.
std::size_t parts_of_parent(double edge, double longest);

/// A nested mesh made from another.
struct FinerMesh {
  NestedMesh mesh;
  std::vector<PatchIndex> place;          ///< per patch: the same patch in the mesh before, or no_patch
  std::vector<PatchIndex> parent_before;  ///< per patch: the parent of the mesh before in which it lies
};

/// How many patches of the mesh before those places are.
PatchIndex number_kept(std::span<const PatchIndex> places);

/// The same with finer patches: those of each parent are cut so many times, and others as in refine(). A parent that
/// was whole has parts after the first time.
FinerMesh cut_patches(const NestedMesh& mesh, std::span<const std::uint8_t> cuts_of_parents);

/// The same where parents are marked: their patches are cut once, and a parent that was whole is cut into four that
/// have parts of their own.
FinerMesh refine(const NestedMesh& mesh, std::span<const std::uint8_t> marked_parents);

/// Sums over the patches of each parent.
Field summed_by_parent(const NestedMesh& mesh, const FieldView& values);

/// The means of a field over each parent, by the areas of its patches.
Field means_by_parent(const NestedMesh& mesh, const FieldView& values, const Eigen::VectorXd& area);

/// Each patch's value is that of its parent.
Field of_parents(const NestedMesh& mesh, const FieldView& parent_values);

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
