#include "plan/close_lamps.h"

#include "visibility/occluder.h"

#include <optional>
#include <sstream>

namespace patchlight {
namespace {

// Patches as small as that all over the scene are an answer only where these are not too many.
std::string advice_for(const Scene& scene, double nearest) {
  constexpr double most_patches = 100'000;
  const char* const by_outline = "cut the surface along the lamp's outline, or move the lamp into the surface";
  double area = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) area += area_vector(corner_points(scene, p)).norm();
  if (area > most_patches * nearest * nearest) return by_outline;
  std::ostringstream edge;
  edge << nearest / scene.metres_per_unit;
  return "compare with mesh.max_edge=" + edge.str() + " in the model's units, or " + by_outline;
}

}  // namespace

Diagnostics notes_on_close_lamps(const Scene& scene, const Occluder& occluder, double max_edge) {
  std::vector<Ray> rays;
  std::vector<PolygonIndex> lamps;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (!emits(scene, p, side)) continue;
      const Vector normal = side == Side::front ? front_normal(scene, p) : Vector(-front_normal(scene, p));
      rays.push_back({area_centroid(corner_points(scene, p)), normal, p});
      lamps.push_back(p);
    }
  }
  const std::vector<std::optional<Hit>> hits = occluder.first_hits(rays);
  std::size_t count = 0;
  double nearest = max_edge / 2;
  PolygonIndex lamp = no_polygon;
  for (std::size_t k = 0; k < hits.size(); ++k) {
    // What a lamp of its own kind hides does not matter.
    if (!hits[k] || is_lamp(scene, hits[k]->polygon) || hits[k]->distance >= max_edge / 2) continue;
    ++count;
    if (hits[k]->distance >= nearest) continue;
    nearest = hits[k]->distance;
    lamp = lamps[k];
  }
  if (lamp == no_polygon) return {};
  std::ostringstream note;
  note << count << (count == 1 ? " lamp faces" : " lamps face")
       << " a surface nearer than its patches are large (nearest: " << place_of(scene, scene.polygons[lamp]) << ", "
       << nearest << " m, patches up to " << max_edge
       << " m): the light between them is spread too far and the answer may be wrong by a factor; "
       << advice_for(scene, nearest);
  return {{DiagnosticCode::close_lamp, note.str(), count}};
}

}  // namespace patchlight
