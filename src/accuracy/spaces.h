#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"
#include "patchlight/solve/problem.h"

#include "visibility/occluder.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// 1 for each patch of a room, e.g. one with windows, else 0: facades, a court, the ground under a table outdoors, a
/// gap below a building. In a room light leaves the scene within four diffuse reflections with a probability below one
/// half, whatever the reflectance; clear faces count as closed. A gap is lower than about a hundredth of the width of
/// its faces. `faces` is an occluder whose rays hit all polygons. Costs at most 64 rays per patch.
Eigen::VectorXd enclosed_patches(const Scene& scene, const Occluder& faces, const PatchMesh& mesh);

/// A place and its unit facing direction, on a polygon or in the air.
struct FacingPlace {
  Point point;
  Vector normal;
  PolygonIndex polygon = no_polygon;
};

/// 1 for each place in a room, by the same rule as patches but without the test for gaps; else 0.
std::vector<std::uint8_t> enclosed_places(const Scene& scene, const Occluder& faces,
                                          std::span<const FacingPlace> places);

/// The closed shells that divide a scene into inside and outside.
enum class Dividing : std::uint8_t { all, with_openings };

/// 1 for each inside patch, else 0. If `enclosed` (Simulation::enclosed) is known, e.g. by daylight, these are the
/// enclosed patches; else those inside shells with openings.
Eigen::VectorXd inside_patches(const Scene& scene, const KeptSides& sides, const PatchMesh& mesh,
                               const Eigen::VectorXd& enclosed);

/// 1 for each patch inside a closed shell, else 0: a patch of a shell that faces its inside, or a patch with its center
/// in front of such a face. Shells without an opaque polygon, e.g. panes with two faces, do not count. O(patches x
/// triangles of the shells around them).
Eigen::VectorXd inside_shells(const Scene& scene, const KeptSides& sides, const PatchMesh& mesh, Dividing by);

/// 1 for each patch of a material, object or group with one of these names, or that faces into a room of this name,
/// else 0. A name that ends in ".inside" or ".outside" means the patches of the named part that are inside a closed
/// shell, or not. If no shell divides these, it means the `enclosed` ones, or the others. ".inside" alone means that
/// side of everything. Without names, 1 for the enclosed patches, or for all if none is enclosed or none of these
/// reflects light. `enclosed` is Simulation::enclosed.
Eigen::VectorXd interest_of(const Scene& scene, const KeptSides& sides, const PatchMesh& mesh,
                            const std::vector<std::string>& names, const Eigen::VectorXd& enclosed);

/// \throws InputError when there are no patches of interest, or none of them reflects light: an accuracy is that of
/// reflected light. Does not throw when all patches are of interest.
void require_reflecting(const Scene& scene, const RadiosityProblem& problem, const Eigen::VectorXd& interest);

/// \throws InputError when nothing in the scene has one of the names.
void require_names(const Scene& scene, const std::vector<std::string>& names);

}  // namespace patchlight
