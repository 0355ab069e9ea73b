#include "lighting/receivers.h"

#include "base/sampling.h"

namespace patchlight {

Receiver receiver_of(const PatchMesh& mesh, PatchIndex patch) {
  const PatchCorners corners = mesh.corner_points(patch);
  const auto place = [&mesh, patch, points = QuadPoints(corners.points)](double u, double v) {
    return SurfacePoint{points.at(u, v), mesh.normal[patch], mesh.polygon[patch]};
  };
  return {place, mesh.side[patch], {corners.points.begin(), corners.points.begin() + corners.count}};
}

Receiver receiver_of(const SurfacePoint& point) {
  return {[&point](double, double) { return point; }, Side::front, {}};
}

}  // namespace patchlight
