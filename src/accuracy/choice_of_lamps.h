#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include <vector>

namespace patchlight {

/// Emitting patches, to be chosen by about what they send somewhere.
struct ChoiceOfLamps {
  std::vector<PatchIndex> lamps;  ///< in the order of the mesh
  std::vector<double> before;     ///< what those before each send, W; one more entry at the end

  struct Chosen {
    PatchIndex lamp;
    double probability;
    double u;  ///< what the choice leaves of the number, in [0, 1]
  };

  /// That of a patch to be chosen; 0 where it is none of them. O(log(lamps)).
  double probability_of(PatchIndex patch) const;

  /// The one that belongs to this number of [0, 1). O(log(lamps)).
  Chosen at(double u) const;
};

/// By what they send to a patch when nothing is in the way; all have some probability. O(lamps).
ChoiceOfLamps choice_of_lamps(const PatchMesh& mesh, PatchIndex patch, const std::vector<PatchIndex>& lamps,
                              const Field& exitance);

/// By all that they send. O(lamps).
ChoiceOfLamps choice_by_flux(const PatchMesh& mesh, const std::vector<PatchIndex>& lamps, const Field& exitance);

}  // namespace patchlight
