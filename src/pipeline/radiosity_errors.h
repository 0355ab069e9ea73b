#pragma once

#include "patchlight/gather/gather.h"
#include "patchlight/simulate.h"

namespace patchlight {

/// What may be wrong with the radiosities of a solution, for gathering them, W/m^2: its error bars where it has any.
/// Otherwise the errors of sampling are taken from how far the row sums were off before closure, and those of the mesh
/// are not known.
RadiosityErrors radiosity_errors(const Simulation& simulation);

}  // namespace patchlight
