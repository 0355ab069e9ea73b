#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/render/image.h"
#include "patchlight/scene/scene.h"

#include "render/lens.h"
#include "visibility/occluder.h"

#include <cstdint>

namespace patchlight {

/// The share of the hemisphere, weighted by the cosine, in which nothing opaque lies within a distance in metres: the
/// mean over each patch, by so many rays. 1 before an open sky, 0 in a closed room smaller than that.
Eigen::VectorXd ambient_occlusion(const PatchMesh& mesh, const Occluder& occluder, double distance,
                                  std::uint32_t rays = 256);

/// What a camera sees of a model whose faces are as bright as their reflectance times that share at each point, on the
/// side that is seen: a picture that needs no light. The occluder must have all faces.
Image ambient_image(const Scene& scene, const Occluder& occluder, const Lens& lens, int width, int height,
                    double distance);

}  // namespace patchlight
