#include "pipeline/ray_form_factors.h"

#include "base/parallel.h"
#include "mesh/mesher.h"
#include "pipeline/ray_light.h"
#include "pipeline/run.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"
#include "plan/memory.h"
#include "visibility/tracing.h"

#include <memory>
#include <utility>

namespace patchlight {

RayFormFactors find_ray_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  Request used = by_rays(request);
  check(used, scene);
  if (used.mesh.sides == Sides::automatic && !has_lamp(scene)) used.mesh.sides = Sides::front;
  Plan plan = plan_form_factors(scene, used);
  require_memory(scene, used, plan);
  PatchMesh mesh = tessellate(scene, plan.sides, plan.max_edge);
  require_memory(mesh.size(), used, plan);

  const auto tracing = std::make_shared<const Tracing>(scene, find_coverings(scene, plan.sides));
  std::vector<std::string> notes;
  for (const Problem& problem : problems_with_overlaps(scene, tracing->coverings())) notes.push_back(problem.what);
  const Steps with;
  const Run run{scene, used, plan, notes, tracing, with, observer};
  RayExchange exchange = trace_ray_exchange(run, plan, mesh);
  return {used, std::move(plan), std::move(mesh), std::move(exchange), std::move(notes)};
}

}  // namespace patchlight
