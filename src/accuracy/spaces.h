#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/solve/problem.h"

#include "visibility/occluder.h"

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// 1 for each patch of a room, e.g. one with windows, else 0: facades, a court, the ground under a table in the open, a
/// gap below a building. In a room light leaves the scene with a probability below one half in four diffuse
/// reflections, whatever the reflectance; clear faces count as closed. A gap is lower than about a hundredth of the
/// width of its faces. `faces` is an occluder whose rays meet all polygons. Costs at most 64 rays per patch.
Eigen::VectorXd enclosed_patches(const Scene& scene, const Occluder& faces, const PatchMesh& mesh);

/// A place and the unit direction that it faces, on a polygon or in the air.
struct FacingPlace {
  Point point;
  Vector normal;
  PolygonIndex polygon = no_polygon;
};

/// 1 for each place in a room, by the same rule as patches, but for gaps; else 0.
std::vector<std::uint8_t> enclosed_places(const Scene& scene, const Occluder& faces,
                                          std::span<const FacingPlace> places);

/// Which closed shells divide a scene into inside and outside.
enum class Dividing : std::uint8_t { all, with_openings };

/// 1 for each patch that is inside, else 0: where `enclosed`, Simulation::enclosed, is known, as by daylight, those
/// that are, else those inside shells with openings.
Eigen::VectorXd inside_patches(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& enclosed);

/// 1 for each patch inside a closed shell: a part of it that faces its inside, or a patch whose centre is before it
/// there; else 0. Shells without an opaque polygon, as panes with two faces are, do not count. O(patches x triangles of
/// the shells around them).
Eigen::VectorXd inside_shells(const Scene& scene, const PatchMesh& mesh, Dividing by);

/// 1 for each patch of a material, object or group with one of these names, or that faces into a room of one, else 0.
/// A name that ends in ".inside" or ".outside" means the patches of the part named before it that are inside a
/// closed shell, or not; where no shell divides these, those that are `enclosed`, or not. ".inside" alone means that
/// side of all. Without names 1 for those that are enclosed, or for all where none is or none reflects light.
/// `enclosed` is Simulation::enclosed.
Eigen::VectorXd interest_of(const Scene& scene, const PatchMesh& mesh, const std::vector<std::string>& names,
                            const Eigen::VectorXd& enclosed);

/// \throws InputError when there is none of these patches, or none of them reflects light: an accuracy is that of
/// reflected light. Not when all patches are of interest.
void require_reflecting(const Scene& scene, const RadiosityProblem& problem, const Eigen::VectorXd& interest);

/// \throws InputError when nothing in the scene has one of the names.
void require_names(const Scene& scene, const std::vector<std::string>& names);

}  // namespace patchlight
