#pragma once

#include "pipeline/light_colours.h"

#include <vector>

namespace patchlight {

/// The solution in all bands of a run from those in each colour, one each: columns next to each other; of what has one
/// number for all bands the mean by luminance, of errors and counts of iterations the worst.
SolvedMesh joined(const Run& run, const std::vector<LightColour>& colours, const MeshToSolve& meshed,
                  std::vector<SolvedMesh> parts);

}  // namespace patchlight
