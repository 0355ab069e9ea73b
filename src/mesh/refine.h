#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace patchlight {

/// A mesh some patches of which are cut.
struct Refinement {
  PatchMesh mesh;
  std::vector<PatchIndex> parent;  ///< per patch: the patch of the mesh before that it is or lies in
};

/// Cuts the marked patches into four by the middles of their edges, and besides them those that would otherwise have a
/// neighbour a quarter of whose edge is shared: neighbours differ by one level at most. Of sheets both sides are cut
/// alike. The four parts of a patch
/// follow each other in its place; neighbours that share an edge share its middle. `marked` has an entry for each
/// patch.
Refinement refine(const PatchMesh& mesh, std::span<const std::uint8_t> marked);

/// Cuts every patch: patch i becomes the patches 4 i to 4 i + 3.
PatchMesh refine(const PatchMesh& mesh);

}  // namespace patchlight
