#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "mesh/mesher.h"
#include "mesh/outline.h"
#include "mesh/patch_lookup.h"
#include "scene/coverings.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace patchlight {

/// A place of the surroundings where importance arrives.
struct ImportanceHit {
  SidePoint at;
  double closeness = 0;  ///< 1 / length of the ray that arrives, 1/m
};

/// The surfaces of interest in a run, and the importance of all others for the light on them. By daylight the goal is
/// the enclosed spaces; the ground, facades, neighbors and terrain are their surroundings.
///
/// Importance is the solution of the adjoint equation psi = goal + F R psi (Smits, Arvo and Salesin 1992). Particles
/// start on the surfaces of the goal and at sensors, and scatter as light does. No mesh is needed, so the search does
/// not miss a small room in a wide terrain.
struct Goal {
  /// Per polygon: 1 where a side lies at least partly in an enclosed space, or is named.
  std::vector<std::uint8_t> is_goal;
  std::vector<ImportanceHit> hits;   ///< equal parts of the importance of the surroundings
  double goal_area = 0;              ///< m^2, of the kept sides of goal polygons
  double share_of_surroundings = 0;  ///< the fraction of the patches, and of the rays, that they get
};

/// The goal of a scene by daylight: the enclosed spaces, or the patches that `interest` names (interest_of()). Null
/// where there is no sky and no sun, no goal, or no surroundings: then every surface counts by its area. Naming the
/// enclosed spaces gives the same goal as no names. Costs a few hundred thousand rays.
std::shared_ptr<const Goal> find_goal(const Scene& scene, const KeptSides& sides, const Coverings& coverings,
                                      const std::vector<std::string>& interest, std::uint64_t seed);

/// The kept sides of the polygons of the goal; all where `goal` is null.
KeptSides sides_of_goal(const KeptSides& sides, const Goal* goal);

/// The edges of patches before cut_by_importance(): patches of the surroundings are as coarse as each polygon allows.
PatchEdges edges_for(const Scene& scene, double max_edge, const Goal* goal);

/// Splits patches of the surroundings in four, the most important first, until there are about `patches` more. The
/// importance of a patch is the sum over its hits of min(1, size / distance)^1.2; the error has the same order in the
/// size.
PatchMesh cut_by_importance(PatchMesh mesh, const Goal& goal, std::size_t patches);

/// The mean area of the patches on goal polygons, m^2; of all where `goal` is null or has no patches.
double mean_area_of_goal(const PatchMesh& mesh, const Goal* goal);

/// The weight of each patch when rays are distributed, m^2: its area on goal polygons, and on the others the area times
/// the importance. The area of all patches where `goal` is null.
std::vector<double> important_areas(const PatchMesh& mesh, const Goal* goal);

}  // namespace patchlight
