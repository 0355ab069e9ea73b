#include "lighting/receiver.h"

#include "base/sampling.h"

#include <cstddef>

namespace patchlight {

std::vector<std::array<double, 4>> shifted(SamplePoints points, std::uint32_t key) {
  constexpr double steps = 0x1p32;
  std::array<std::uint32_t, 4> shift;
  for (std::uint32_t d = 0; d < 4; ++d) shift[d] = hash({key, d});
  std::vector<std::array<double, 4>> moved(points.begin(), points.end());
  for (std::array<double, 4>& point : moved) {
    for (std::size_t d = 0; d < 4; ++d)
      point[d] = (static_cast<double>(static_cast<std::uint32_t>(point[d] * steps) ^ shift[d]) + 0.5) / steps;
  }
  return moved;
}

Estimate estimate_of(const Field& replicates) {
  const Spectrum mean = replicates.colwise().mean();
  if (replicates.rows() == 1) return {mean, mean.square()};
  const Spectrum squares = replicates.square().colwise().mean();
  return {mean, (squares - mean.square()).max(0.0) / static_cast<double>(replicates.rows() - 1)};
}

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

bool is_covered(const Lighting& lighting, const Receiver& receiver, const SurfacePoint& at) {
  return at.polygon != no_polygon && lighting.paths.is_covered(at.polygon, receiver.side, at.point);
}

}  // namespace patchlight
