#include "mesh/small_patches.h"

#include <numeric>

namespace patchlight {

double mean_area(const PatchMesh& mesh) {
  return std::accumulate(mesh.area.begin(), mesh.area.end(), 0.0) / static_cast<double>(mesh.size());
}

double small_area(const PatchMesh& mesh) { return mean_area(mesh) / 16; }

}  // namespace patchlight
