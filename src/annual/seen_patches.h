#pragma once

#include "patchlight/base/field.h"
#include "patchlight/scene/sensor.h"

#include "gather/sources.h"

#include <cstdint>
#include <span>

namespace patchlight {

/// The irradiance at each sensor by a radiosity of 1 on each patch, straight or through panes and mirrors: a row for
/// each patch, for each sensor one column after the other for its bands. `each` rays in each of most_replicates.
Field seen_patches(const HemisphereRays& hemisphere, const PatchMesh& mesh, std::span<const Sensor> sensors,
                   Eigen::Index bands, std::uint32_t each, double tolerance);

}  // namespace patchlight
