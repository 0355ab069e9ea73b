#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include <span>

namespace patchlight {

/// The mean of areas, m^2.
double mean_area(std::span<const double> areas);

/// The mean area of the patches, m^2.
double mean_area(const PatchMesh& mesh);

/// The area in m^2 below which a patch is small: a sixteenth of the mean. In models with fine parts most patches are,
/// and have together some thousandths of all area, so that less work on each of them saves much and costs little.
double small_area(const PatchMesh& mesh);

}  // namespace patchlight
