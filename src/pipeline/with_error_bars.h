#pragma once

#include "patchlight/base/field.h"

#include "pipeline/mesh_transport.h"
#include "pipeline/run.h"

#include <array>
#include <optional>

namespace patchlight {

/// A rough irradiance by luminaires, sun and sky, W/m^2, by two halves of rays: patch i has the rows 4 i to 4 i + 3,
/// one for each of its quarters. Empty where there is no such light.
using QuarterLight = std::array<Field, 2>;

/// Only differences within a patch count. The light is 0 on patches below 1/64 of the mean area of the goal's patches.
/// A limit of 1/16 would miss the frames and sills of windows. \throws Canceled.
QuarterLight light_at_quarters(const Run& run, const Plan& plan, const PatchMesh& mesh);

/// Adds error bars and the effects of finer patches to a solved mesh, if the plan has error bars. \throws InputError
/// when no patch of the plan's interest exists or reflects light. `light` is that of light_at_quarters(), if it is
/// known.
SolvedMesh with_error_bars(const Run& run, SolvedMesh result, MeshTransport transport,
                           std::optional<QuarterLight> light = {});

}  // namespace patchlight
