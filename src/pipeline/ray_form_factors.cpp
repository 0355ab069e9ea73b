#include "pipeline/ray_form_factors.h"

#include "base/parallel.h"
#include "pipeline/exchange_and_light.h"
#include "pipeline/run.h"
#include "pipeline/scene_in_patches.h"
#include "plan/choose_storage.h"

#include <utility>

namespace patchlight {

RayFormFactors find_ray_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  SceneInPatches found = scene_in_patches(scene, by_rays(request));
  const Steps with;
  const Run run{scene, found.request, found.plan, found.notes, found.tracing, with, observer};
  RayExchange exchange = trace_ray_exchange(run, found.plan, found.mesh);
  return {std::move(found.request), std::move(found.plan), std::move(found.mesh), std::move(exchange),
          std::move(found.notes)};
}

}  // namespace patchlight
