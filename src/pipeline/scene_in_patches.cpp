#include "pipeline/scene_in_patches.h"

#include "pipeline/first_mesh.h"
#include "plan/check_request.h"
#include "plan/memory.h"
#include "plan/planned_scene.h"

#include <utility>

namespace patchlight {

SceneInPatches scene_in_patches(const Scene& scene, Request request) {
  check(request, scene);
  if (request.mesh.sides == Sides::automatic && !has_lamp(scene)) request.mesh.sides = Sides::front;
  Plan plan = plan_form_factors(scene, request);
  require_memory(scene, request, plan);
  auto world = std::make_shared<const World>(std::make_shared<const Scene>(scene), plan);
  PatchMesh mesh = open_patches(scene, plan, plan.max_edge, world->between_patches());
  require_memory(mesh.size(), request, plan);
  Diagnostics notes = problems_with_overlaps(scene, world->tracing().coverings());
  return {std::move(request), std::move(plan), std::move(mesh), std::move(world), std::move(notes)};
}

}  // namespace patchlight
