#include "pipeline/form_factors.h"

#include "patchlight/form_factors.h"

#include "base/parallel.h"
#include "pipeline/exchange_and_light.h"
#include "pipeline/first_mesh.h"
#include "pipeline/run.h"
#include "plan/check_request.h"
#include "plan/choose_storage.h"
#include "transport/closure.h"
#include "transport/ray_rows.h"

#include <memory>
#include <utility>

namespace patchlight {
namespace {

// The patches of a scene without its light.
struct SceneInPatches {
  Request request;  // as executed
  Plan plan;
  PatchMesh mesh;
  std::shared_ptr<const World> world;
  Diagnostics notes;  // on polygons that lie one on the other
};

// Without a lamp Sides::automatic means the front sides.
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

}  // namespace

RayFormFactors find_ray_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  SceneInPatches found = scene_in_patches(scene, by_rays(request));
  const Steps with;
  const Run run{scene, found.request, found.plan, found.notes, found.world, with, observer};
  RayExchange exchange = exchange_and_light(run, found.plan, found.mesh).exchange;
  TracedRows rows = weighed_rows(exchange.rows, found.mesh, found.world->between_patches());
  const Eigen::VectorXd row_sum = RayTransport(std::move(rows.halves)).row_sums();
  return {
      std::move(found.request), std::move(found.plan), std::move(found.mesh), std::move(exchange), rows.area, row_sum,
      std::move(found.notes)};
}

FormFactors find_form_factors(const Scene& scene, const Request& request, const Observer& observer) {
  const ThreadLimit threads(request.resources.threads);
  Request kept = request;
  kept.assembly.storage = Storage::tiles;
  SceneInPatches found = scene_in_patches(scene, std::move(kept));
  const Plan& plan = found.plan;
  Exchange exchange = trace_exchange(found.mesh, found.world->between_patches(), plan.assembly, observer);
  if (plan.assembly.close) {
    ClosedExchangeAreas closed = close_exchange_areas(std::move(exchange.exchange_areas), exchange.area, exchange.lost,
                                                      exchange.half_differences, observer);
    exchange.exchange_areas = std::move(closed.exchange_areas);
    exchange.closure = closed.method;
    if (!plan.assembly.keep_errors) exchange.half_differences = {};
  }
  return {std::move(found.request), std::move(found.plan), std::move(found.mesh), std::move(exchange),
          std::move(found.notes)};
}

}  // namespace patchlight
