#pragma once

#include "patchlight/simulate.h"

#include <array>
#include <cstdint>
#include <vector>

namespace patchlight {

/// Display colours (sRGB, 8 bits) at the mesh's vertices: of the radiance there, exposed.
std::vector<std::array<std::uint8_t, 3>> vertex_colours(const Scene& scene, const Simulation& simulation,
                                                        double exposure);

}  // namespace patchlight
