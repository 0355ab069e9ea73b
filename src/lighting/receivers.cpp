#include "lighting/receivers.h"

#include "base/sampling.h"

namespace patchlight {

std::vector<Receiver> receivers_of(const PatchMesh& mesh) {
  std::vector<Receiver> receivers;
  for (PatchIndex i = 0; i < mesh.size(); ++i) {
    const auto place = [&mesh, i](double u, double v) {
      return SurfacePoint{square_to_quad(mesh.corner_points(i).points, u, v), mesh.normal[i], mesh.polygon[i]};
    };
    const PatchCorners corners = mesh.corner_points(i);
    receivers.push_back({place, mesh.side[i], {corners.points.begin(), corners.points.begin() + corners.count}});
  }
  return receivers;
}

std::vector<Receiver> receivers_of(std::span<const SurfacePoint> points) {
  std::vector<Receiver> receivers;
  for (const SurfacePoint& point : points)
    receivers.push_back({[&point](double, double) { return point; }, Side::front, {}});
  return receivers;
}

}  // namespace patchlight
