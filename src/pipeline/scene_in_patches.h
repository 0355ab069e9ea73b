#pragma once

#include "patchlight/mesh/patch_mesh.h"
#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "pipeline/world.h"

#include <memory>

namespace patchlight {

/// The patches of a scene, and what rays between them need: where form factors are looked for and no light.
struct SceneInPatches {
  Request request;  ///< as it is carried out
  Plan plan;
  PatchMesh mesh;
  std::shared_ptr<const World> world;
  Diagnostics notes;  ///< on polygons that lie one on the other
};

/// Without a lamp Sides::automatic means the front sides. \throws InputError, MemoryError.
SceneInPatches scene_in_patches(const Scene& scene, Request request);

}  // namespace patchlight
