#include "plan/left_out_sides.h"

#include <cstddef>
#include <cstdint>

namespace patchlight {
namespace {

constexpr const char* advice = "\nhint: compute the form factors again with the present lamps";

bool is_kept(const KeptSides& kept, PolygonIndex polygon, Side side) {
  return (side == Side::front ? kept.front : kept.back)[polygon] != 0;
}

// Names of the materials that emit, but from no kept side.
std::vector<std::string> dark_lamps(const Scene& scene, const KeptSides& kept) {
  std::vector<std::uint8_t> emits_somewhere(scene.materials.size(), 0);
  std::vector<std::uint8_t> emits_from_kept(scene.materials.size(), 0);
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) {
      if (!emits(scene, p, side)) continue;
      const MaterialIndex material = material_on(scene.polygons[p], side);
      emits_somewhere[material] = 1;
      if (is_kept(kept, p, side)) emits_from_kept[material] = 1;
    }
  }
  std::vector<std::string> names;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (emits_somewhere[m] && !emits_from_kept[m]) names.push_back(scene.materials[m].name);
  }
  return names;
}

}  // namespace

Diagnostics notes_on_left_out_sides(const Scene& scene, const KeptSides& kept, Sides sides) {
  Diagnostics notes;
  for (const std::string& name : dark_lamps(scene, kept)) {
    notes.push_back({DiagnosticCode::lost_light,
                     "material '" + name + "' emits, but no light comes from it: its faces were left out of the " +
                         "form factors" + advice});
  }
  const KeptSides now = kept_sides(scene, sides);
  std::size_t left_out = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    for (const Side side : {Side::front, Side::back}) left_out += is_kept(now, p, side) && !is_kept(kept, p, side);
  }
  if (left_out == 0) return notes;
  notes.push_back(
      {DiagnosticCode::lost_light,
       "with these lamps " + std::to_string(left_out) + (left_out == 1 ? " side" : " sides") +
           " of faces would take part that did not when the form factors were made: light that arrives there " +
           "is lost" + advice});
  return notes;
}

}  // namespace patchlight
