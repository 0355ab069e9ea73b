#include "base/sampling.h"
#include "form_factor/point_polygon.h"
#include "form_factor/solid_angle.h"
#include "transport/estimators.h"
#include "transport/pair_by_pair.h"
#include "visibility/occluder.h"

#include <algorithm>

namespace patchlight {
namespace {

PairSample draw_by_solid_angle(const PatchShape& smaller, const PatchShape& larger, const std::array<double, 4>& at) {
  const Point x = square_to_quad(smaller.corners.points, at[0], at[1]);
  const PolygonSample y = sample_solid_angle(x, smaller.normal, larger.corners, at[2], at[3]);
  const double exact = point_to_polygon(x, smaller.normal, larger.corners);
  return {x, y.point, smaller.area * y.weight, smaller.area * exact};
}

// The exact value less what is blocked, a control variate, unless most is blocked: the error is that of the smaller
// part.
double exchange_area(const PatchShape&, const PatchShape&, const SampleMeans& means) {
  if (means.visible < means.blocked) return means.visible;
  return std::max(0.0, means.unoccluded - means.blocked);
}

}  // namespace

Assembly estimate_by_points(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                            const Observer& observer) {
  return pair_by_pair(mesh, occluder, options, {draw_by_solid_angle, exchange_area}, observer);
}

}  // namespace patchlight
