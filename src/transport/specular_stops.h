#pragma once

#include "patchlight/mesh/patch_mesh.h"

#include "scene/specular_faces.h"

#include <cstdint>
#include <functional>
#include <span>

namespace patchlight {

/// What becomes of a ray of a row at a stop.
enum class RayStep : std::uint8_t {
  sent,      ///< it starts from a clear polygon
  crossed,   ///< a shadow ray goes straight through a clear polygon
  through,   ///< a ray over the hemisphere goes straight through, drawn by SpecularFace::mirrored_rays()
  mirrored,  ///< or on as from a mirror
  kept,      ///< it ends on a polygon that is specular, with what that holds
  ends       ///< it ends, with all that is left
};
inline constexpr std::uint32_t ray_steps = 6;

/// A stop of a ray that is specular on its way, so that what it tells is another form factor for each colour of the
/// clear polygons and mirrors on it: geometry alone, 16 bytes. The ray is all stops up to one with `kept` or `ends`.
struct SpecularStop {
  static constexpr PatchIndex in_the_open = no_patch;  ///< a ray has left the scene
  static constexpr PatchIndex at_back = no_patch - 1;  ///< it meets a side without patches, or what lies on the patch

  PatchIndex patch = in_the_open;     ///< what is met
  float form_factor = 0;              ///< what the ray counts there, if nothing was lost on its way and all is held
  PolygonIndex polygon = no_polygon;  ///< the specular polygon that is met, or from which the ray starts
  std::uint32_t bits = 0;             ///< step, side and cosine of the angle there

  void set(RayStep step, Side side, double cosine);
  RayStep step() const { return static_cast<RayStep>(bits & 7U); }
  Side side() const { return static_cast<Side>(bits >> 3U & 1U); }
  double cosine() const { return static_cast<double>(bits >> 4U) * 0x1p-28; }
};

/// What rays tell for one colour, ray by ray: tell(stop, form factor) at every stop, 0 where nothing is held.
void tell_form_factors(std::span<const SpecularStop> stops, const SpecularFaces& faces,
                       const std::function<void(const SpecularStop& stop, double form_factor)>& tell);

}  // namespace patchlight
