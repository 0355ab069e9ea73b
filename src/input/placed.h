#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with its vertices moved, in metres. A mirrored polygon is walked the other way round, so that its front
/// stays the front.
Scene placed(Scene scene, const Eigen::Affine3d& placement);

}  // namespace patchlight
