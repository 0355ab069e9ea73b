#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/contact_lines.h"
#include "patchlight/scene/sides.h"

#include "mesh/outline.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace patchlight {

/// Patches have 32-bit indices.
inline constexpr double max_patches = 0x1p31;

/// \throws MemoryError when more than 2^31 patches would be needed.
void require_so_many_patches(const Scene& scene, const KeptSides& sides, const PatchEdges& edges);

/// Subdivides the kept sides of every polygon into patches. No edge of a patch is longer than `edges` allows.
///
/// An edge is cut into ceil(length / max_edge) equal parts, so neighbors with the same limit share its points. An
/// outline that is finer than that and meets no third face is first made coarser, see coarse_outline(). Convex
/// quadrilaterals with equal counts on opposite edges become a grid of quadrilaterals. Triangles with three equal
/// counts become a grid of triangles. Every other polygon becomes a Delaunay mesh of triangles: an equilateral lattice
/// inside, split at the longest inner edge until all are short enough.
///
/// Patches of one polygon side are numbered consecutively. Neighbors share vertices only if they have one material,
/// their normals differ by less than 30 degrees, and no wall stands between them. Both sides of a polygon have their
/// own vertices. Patches end at lines of contact, see cut_polygons(), and share no vertices across them; a polygon with
/// such lines becomes a Delaunay mesh around them. With graded edges, the quadrilaterals of grids shrink towards edges
/// where lit faces meet, see graded(). Their number stays the same; edges in the middle are longer than `max_edge` by
/// up to a factor of pi / 2. \throws MemoryError if more than 2^31 patches would be needed.
PatchMesh tessellate(const Scene& scene, const KeptSides& sides, const PatchEdges& edges,
                     const ContactLines& contacts = {}, bool graded_edges = false);

/// The number of patches when no edge is cut: the least there can be.
std::size_t least_patches(const Scene& scene, const KeptSides& sides, const ContactLines& contacts = {});

/// The number of patches with edges of `max_edge` at most. \throws MemoryError for more than 2^31 patches.
std::size_t number_of_patches(const Scene& scene, const KeptSides& sides, double max_edge,
                              const ContactLines& contacts = {});

/// Per polygon how many corners of its outline patches do without, see coarse_outline().
std::vector<std::size_t> left_out_corners(const Scene& scene, double max_edge);

/// An edge for which the number of patches is within 0.5 % of `patches`, or as near as the steps in which the number
/// can change allow. Costs some three tessellations; much less where all polygons become grids or stay whole. \throws
/// MemoryError for more than 2^31 patches.
double max_edge_for(const Scene& scene, const KeptSides& sides, std::size_t patches, const ContactLines& contacts = {});

/// Searches edges for several numbers of patches. Each result narrows the next search.
class EdgeSearch {
 public:
  /// Keeps references to all three.
  EdgeSearch(const Scene& scene, const KeptSides& sides, const ContactLines& contacts);
  ~EdgeSearch();
  EdgeSearch(const EdgeSearch&) = delete;
  EdgeSearch& operator=(const EdgeSearch&) = delete;
  double edge_for(std::size_t patches);
  double patches_with(double max_edge);
  /// The edge of parents for a number of parts, see nest(). The tolerance is 5 % of the number above the least, or the
  /// steps in which it can change. \throws MemoryError like max_edge_for().
  double nested_edge_for(std::size_t patches);
  /// The parts of parents with edges of `max_edge` at most.
  double nested_patches_with(double max_edge);
  /// least_patches()
  std::size_t least_patches();

 private:
  class PatchNumber;
  std::unique_ptr<PatchNumber> number_;
};

}  // namespace patchlight
