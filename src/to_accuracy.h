#pragma once

#include "solve_mesh.h"

namespace patchlight {

/// Solves on finer and finer meshes, with more samples where these are what limits, until the plan's accuracy is
/// reached or its time is up. What is known of one mesh is used for the next. \throws MemoryError when the accuracy
/// takes more memory than the request allows, with the accuracy that can be reached.
SolvedMesh solve_to_accuracy(const Setting& setting, const Request& request, const Plan& plan, StageClock& clock);

}  // namespace patchlight
