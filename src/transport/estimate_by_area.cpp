#include "transport/estimators.h"
#include "transport/pair_by_pair.h"
#include "visibility/occluder.h"

namespace patchlight {

Assembly estimate_by_area(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                          const Observer& observer) {
  const auto visible = [](const PatchShape&, const PatchShape&, const SampleMeans& means) { return means.visible; };
  return pair_by_pair(mesh, occluder, options, {draw_by_area, visible}, observer);
}

}  // namespace patchlight
