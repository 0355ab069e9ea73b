#pragma once

#include "patchlight/plan/plan.h"
#include "patchlight/scene/scene.h"

#include "transport/ray_transport.h"

#include <Eigen/Core>

namespace patchlight {

/// Rows of rays between the patches of a scene.
struct RayFormFactors {
  Request request;  ///< as executed
  Plan plan;
  PatchMesh mesh;
  RayExchange exchange;
  Eigen::VectorXd area;     ///< m^2, the exposed area, times the share that a clear patch holds
  Eigen::VectorXd row_sum;  ///< the visible share of each patch. Area and row_sum are for the mean of all colors
  Diagnostics notes = {};   ///< on polygons that lie one on the other
};

/// The counterpart of find_form_factors(), for Steps::ray_exchange. \throws InputError, MemoryError, Canceled.
RayFormFactors find_ray_form_factors(const Scene& scene, const Request& request, const Observer& observer = {});

}  // namespace patchlight
