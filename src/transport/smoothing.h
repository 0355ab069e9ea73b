#pragma once

#include "patchlight/base/field.h"
#include "patchlight/mesh/patch_mesh.h"

#include <array>
#include <span>

namespace patchlight {

/// Two independent estimates of an irradiance, smoothed, and what their mean still scatters.
struct SmoothedHalves {
  std::array<Field, 2> halves;
  Field variance;  ///< of the mean of both
};

/// Smooths two independent estimates of the irradiance between patches alike: each patch takes the value at its
/// centroid of the area-weighted linear regression over its neighbours, at most some 32. Neighbours lie within a fifth
/// of the harmonic mean `distance` of what each of the two sees (metres; Ward, Rubinstein and Clear 1988 show that
/// irradiance varies no faster), look the same way within 25 degrees, and lie in about one plane: so nothing is carried
/// across an edge, or a wall that stands on a face. A patch that both halves tell to be far off its neighbours, by more
/// than errors are, keeps its own values: one behind another face may look into another space. Only for light of which
/// no source is small: the shadows of lamps are sharper. The variance takes the scatter of the halves as equal among
/// neighbours. O(size) for patches of even sizes. The same bits for any number of threads.
SmoothedHalves smoothed(const PatchMesh& mesh, std::span<const float> distance, const std::array<Field, 2>& halves);

}  // namespace patchlight
