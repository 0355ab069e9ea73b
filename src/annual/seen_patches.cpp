#include "annual/seen_patches.h"

#include "base/parallel.h"

#include <cstddef>

namespace patchlight {

std::vector<PatchPlane> planes_of(const PatchMesh& mesh, const Occluder& occluder, const Observer& observer) {
  const PlaneFits fits(mesh, occluder);
  std::vector<PatchPlane> planes(mesh.size());
  parallel_for(mesh.size(), Stage::gather, observer, [&](std::size_t k) {
    const auto j = static_cast<PatchIndex>(k);
    planes[k].around = fits.in_sight(j, fits.patches_around(j));
    planes[k].slopes = fits.slopes(j, planes[k].around);
  });
  return planes;
}

Field seen_patches(const SeenBy& by, std::span<const Sensor> sensors, std::uint32_t each) {
  const PatchMesh& mesh = by.mesh;
  Field seen = Field::Zero(mesh.size(), static_cast<Eigen::Index>(sensors.size()) * by.bands);
  parallel_for(sensors.size(), [&](std::size_t k) {
    const Sensor& sensor = sensors[k];
    const auto first = static_cast<Eigen::Index>(k) * by.bands;
    const auto add = [&](PatchIndex j, const Spectrum& weight) { seen.row(j).segment(first, by.bands) += weight; };
    for (const HemisphereHit& hit : by.hemisphere.hits(sensor, each, 0).all) {
      // A sensor on a face does not see the patches of that face.
      const double height = mesh.normal[hit.patch].dot(sensor.point - mesh.centroid[hit.patch]);
      if (!hit.is_mirrored && height <= by.tolerance) continue;
      add(hit.patch, hit.weight);
      const PatchPlane& plane = by.planes[hit.patch];
      const Vector way = hit.point - mesh.centroid[hit.patch];
      for (std::size_t n = 0; n < plane.around.size(); ++n) {
        const double share = way.dot(plane.slopes.col(static_cast<Eigen::Index>(n)));
        add(plane.around[n], share * hit.weight);
        add(hit.patch, -share * hit.weight);
      }
    }
  });
  return seen;
}

}  // namespace patchlight
