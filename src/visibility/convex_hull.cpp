#include "visibility/convex_hull.h"

#include "scene/half_spaces.h"

namespace patchlight {

std::vector<std::uint8_t> on_convex_hull(const Scene& scene) {
  const HalfSpaces occupied = occupied_half_spaces(scene);
  std::vector<std::uint8_t> result;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p)
    result.push_back(!(occupied.before[p] && occupied.behind[p]));
  return result;
}

}  // namespace patchlight
