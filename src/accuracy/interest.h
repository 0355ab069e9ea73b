#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/scene/scene.h"
#include "patchlight/solve/problem.h"

#include <Eigen/Core>
#include <string>
#include <vector>

namespace patchlight {

/// 1 for each patch of a material, object or group with one of these names, or that faces into a room of one, else 0.
/// A name that ends in ".inside" or ".outside" means the patches of what is named before that are inside a closed
/// shell, or not; where no shell divides these, those that are `enclosed`, or not. ".inside" alone means that side of
/// all. Without names 1 for those that are enclosed, or for all where none is or none reflects light. `enclosed` is
/// Simulation::enclosed.
Eigen::VectorXd interest_of(const Scene& scene, const PatchMesh& mesh, const std::vector<std::string>& names,
                            const Eigen::VectorXd& enclosed);

/// \throws InputError when there is none of these patches, or none of them reflects light: an accuracy is that of
/// reflected light. Not when all patches are of interest.
void require_reflecting(const Scene& scene, const RadiosityProblem& problem, const Eigen::VectorXd& interest);

/// \throws InputError when nothing in the scene has one of the names.
void require_names(const Scene& scene, const std::vector<std::string>& names);

}  // namespace patchlight
