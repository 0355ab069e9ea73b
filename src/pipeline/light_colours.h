#pragma once

#include "pipeline/run.h"

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace patchlight {

/// Bands for which clear faces and mirrors are alike. Each color of light has one set of form factors over these faces.
struct LightColour {
  std::vector<Eigen::Index> bands;  ///< of the run's scene
  std::shared_ptr<const World> world;
};

/// The colors that a ray run distinguishes; empty where one set of form factors serves all bands.
std::vector<LightColour> light_colours(const Run& run);

/// Solves a mesh in each color separately, and combines the solutions. \throws Canceled, InputError.
SolvedMesh solved_in_colours(const Run& run, const std::vector<LightColour>& colours, const MeshToSolve& meshed,
                             StageClock& clock);

}  // namespace patchlight
