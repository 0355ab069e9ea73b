#include "mesh/small_patches.h"

#include <numeric>

namespace patchlight {

double mean_area(std::span<const double> areas) {
  return std::accumulate(areas.begin(), areas.end(), 0.0) / static_cast<double>(areas.size());
}

double mean_area(const PatchMesh& mesh) { return mean_area(std::span<const double>(mesh.area)); }

double small_area(const PatchMesh& mesh) { return mean_area(mesh) / 16; }

}  // namespace patchlight
