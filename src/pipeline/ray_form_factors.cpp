#include "pipeline/ray_form_factors.h"

#include "base/parallel.h"
#include "pipeline/exchange_and_light.h"
#include "pipeline/run.h"
#include "pipeline/scene_in_patches.h"
#include "plan/choose_storage.h"
#include "transport/ray_rows.h"
#include "transport/ray_transport.h"

#include <utility>

namespace patchlight {

RayFormFactors find_ray_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  SceneInPatches found = scene_in_patches(scene, by_rays(request));
  const Steps with;
  const Run run{scene, found.request, found.plan, found.notes, found.world, with, observer};
  RayExchange exchange = trace_ray_exchange(run, found.plan, found.mesh);
  TracedRows rows = weighed_rows(exchange.rows, found.mesh, found.world->between_patches());
  const RayTransport transport(std::move(rows.halves));
  const Eigen::VectorXd row_sum = transport.apply(Field::Ones(found.mesh.size(), 1)).matrix();
  return {
      std::move(found.request), std::move(found.plan), std::move(found.mesh), std::move(exchange), rows.area, row_sum,
      std::move(found.notes)};
}

}  // namespace patchlight
