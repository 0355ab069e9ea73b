#pragma once

#include "pipeline/run.h"

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace patchlight {

/// Bands that clear faces and mirrors treat alike. Form factors over these are one set for each colour of light.
struct LightColour {
  std::vector<Eigen::Index> bands;  ///< of the run's scene
  std::shared_ptr<const World> world;
};

/// The colours that a run by rows of rays distinguishes; empty where one set of form factors holds for all bands.
std::vector<LightColour> light_colours(const Run& run);

/// A mesh solved in each colour by itself, as if it was all light that there is, and put together. \throws Cancelled,
/// InputError.
SolvedMesh solved_in_colours(const Run& run, const std::vector<LightColour>& colours, const MeshToSolve& meshed,
                             StageClock& clock);

}  // namespace patchlight
