#include "output/vertex_colours.h"

#include "patchlight/mesh/interpolate.h"
#include "patchlight/render/tone_map.h"

#include <numbers>

namespace patchlight {

std::vector<std::array<std::uint8_t, 3>> vertex_colours(const Simulation& simulation, double exposure) {
  const Field radiance = simulation.solution.radiosity / std::numbers::pi;  // L = B / pi
  return tone_map(vertex_means(simulation.mesh, radiance, simulation.problem.area), exposure);
}

}  // namespace patchlight
