#include "annual/seen_patches.h"

#include "base/parallel.h"

#include <cstddef>

namespace patchlight {

Field seen_patches(const HemisphereRays& hemisphere, const PatchMesh& mesh, std::span<const Sensor> sensors,
                   Eigen::Index bands, std::uint32_t each, double tolerance) {
  Field seen = Field::Zero(mesh.size(), static_cast<Eigen::Index>(sensors.size()) * bands);
  parallel_for(sensors.size(), [&](std::size_t k) {
    const Sensor& sensor = sensors[k];
    const auto first = static_cast<Eigen::Index>(k) * bands;
    for (const HemisphereHit& hit : hemisphere.hits(sensor, each, 0).all) {
      // A sensor on a face does not see the patches of that face.
      const double height = mesh.normal[hit.patch].dot(sensor.point - mesh.centroid[hit.patch]);
      if (!hit.is_mirrored && height <= tolerance) continue;
      seen.row(hit.patch).segment(first, bands) += hit.weight;
    }
  });
  return seen;
}

}  // namespace patchlight
