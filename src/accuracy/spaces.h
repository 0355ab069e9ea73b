#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"

#include <Eigen/Core>
#include <cstdint>

namespace patchlight {

/// Which closed shells divide a scene into inside and outside.
enum class Dividing : std::uint8_t { all, with_openings };

/// 1 for each patch that is inside, else 0: where `enclosed`, Simulation::enclosed, is known, as by daylight, those
/// that are, else those inside shells with openings.
Eigen::VectorXd inside_patches(const Scene& scene, const PatchMesh& mesh, const Eigen::VectorXd& enclosed);

/// 1 for each patch inside a closed shell: a part of it that faces its inside, or a patch whose centre is before it
/// there; else 0. Shells without an opaque polygon, as panes with two faces are, do not count. O(patches x triangles of
/// the shells around them).
Eigen::VectorXd inside_shells(const Scene& scene, const PatchMesh& mesh, Dividing by);

}  // namespace patchlight
