#include "form_factor/contour.h"
#include "transport/estimators.h"
#include "transport/pair_by_pair.h"
#include "visibility/occluder.h"

namespace patchlight {

Assembly estimate_by_contour(const PatchMesh& mesh, const Occluder& occluder, const AssemblyOptions& options,
                             const Observer& observer) {
  const auto share_of_contour = [](const PatchShape& first, const PatchShape& second, const SampleMeans& means) {
    const double U = contour_exchange_area(first.corners, second.corners);
    // Without a sample that says otherwise the pair counts as visible.
    return means.blocked != 0 ? U * means.visible / (means.visible + means.blocked) : U;
  };
  return pair_by_pair(mesh, occluder, options, {draw_by_area, share_of_contour}, observer);
}

}  // namespace patchlight
