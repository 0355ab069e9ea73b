#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include "visibility/occluder.h"

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace patchlight {

/// A piece of a floor and the light that it reflects.
struct FloorPiece {
  Point middle;
  PolygonIndex polygon = no_polygon;
  double light = 0;  ///< W, or another measure of how much it counts
};

/// How bright the two sides of each polygon are, per area; -1 where a side has no part.
struct SideLight {
  Eigen::VectorXd front, back;
};

/// A view inside the room that has most light: of places at eye height above the floors that with the most light on the
/// surfaces it sees, from the end of the room that sees most of them. Nothing where no place is under a ceiling and
/// within surfaces nearly all around. Takes some 60 places; they are chosen by the light of their floor.
std::optional<Camera> inside_camera(const std::vector<FloorPiece>& floors, const SideLight& light, const Scene& scene,
                                    const Occluder& occluder);

/// The floors of a mesh and how bright sides are, by one value per patch and area; 0 for patches that do not count.
std::vector<FloorPiece> floors_of(const PatchMesh& mesh, const Eigen::VectorXd& light, const Vector& up);
/// The same of a model without light: reflectances, and areas of floors times these.
std::vector<FloorPiece> floors_of(const Scene& scene, const SideLight& light);
SideLight reflectance_of_sides(const Scene& scene, const KeptSides& sides);

SideLight light_of_sides(const PatchMesh& mesh, const Eigen::VectorXd& light, std::size_t polygons);

}  // namespace patchlight
