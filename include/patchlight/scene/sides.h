#pragma once

#include "patchlight/scene/scene.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace patchlight {

/// Which sides of the polygons are simulated.
enum class Sides {
  automatic,  ///< all but those into the dark: inside a closed solid without a lamp, outside of one around all lamps,
              ///< or with nothing before them
  front,      ///< the front sides only; of polygons whose back is a face of its own both
  both        ///< both sides of every polygon
};

/// "auto", "front" or "both", as on the command line.
const char* name_of(Sides sides);

/// A closed solid into which no light can get.
struct DarkSolid {
  std::string name;          ///< that of its group, with the place of its first polygon: "'attic' (house.obj:12)"
  std::size_t polygons = 0;  ///< that it consists of
};

struct SceneGeometry;

/// The sides that become patches, per polygon.
struct KeptSides {
  std::vector<std::uint8_t> front;  ///< 1 when the polygon's front side is kept
  std::vector<std::uint8_t> back;   ///< 1 when its back side is kept
  bool emit_from_back = false;      ///< lamps emit from their back sides too (Sides::both)
  Diagnostics notes;                ///< the decisions, for the report
  std::vector<DarkSolid> dark_solids = {};
  std::size_t unreached = 0;    ///< sides that face the inside of one
  std::size_t turned_away = 0;  ///< sides that face the dark outside of a closed solid, or nothing at all
  std::shared_ptr<const SceneGeometry> geometry =
      {};  ///< shells and solids of the scene; null in sides that kept_sides() has not made
};

/// Sides that no light reaches and that are kept nevertheless.
struct KeptInTheDark {
  bool unreached = false;    ///< those that face the inside of a dark solid
  bool turned_away = false;  ///< those that face the dark outside of a closed solid
};

/// Chooses the sides. A solid is a closed shell of polygons with a volume. Opaque faces of others may close its rims,
/// e.g. a block without a bottom that stands on a floor. Its turned polygons are seen as if turned back. A solid holds
/// a lamp if a part of an emitting side or of a luminaire lies in it, with winding number +-1. A lamp that crosses its
/// surface, or comes within 5e-7 of the scene's extent, counts as both inside and outside, so that no light is lost.
/// Sun and sky shine from outside. Clear openings let light in and out.
///
/// Sides::automatic keeps a side unless
/// - it faces the inside of a dark solid: a closed solid that holds no lamp and has no opening to one outside. The side
///   belongs to the solid itself, or there is light elsewhere and all its corners and the point before its middle lie
///   inside; or
/// - it faces the outside of a closed shell that holds every lamp of the scene, or lies beside the bounds of one
///   without openings: no light gets there; or
/// - nothing of the scene and no luminaire lies before its plane, it does not emit, and there is no sun or sky.
///
/// `in_the_dark` keeps such sides nevertheless; they are still counted, those of the last kind as turned away. The
/// search for contents of dark solids has a limit of work; sides beyond it are kept. The inner sides of a closed room
/// are used even if its normals point outward; a note reports this.
///
/// `geometry` is that of the scene, as other sides of it have it; it is computed when null.
KeptSides kept_sides(const Scene& scene, Sides sides, const KeptInTheDark& in_the_dark = {},
                     std::shared_ptr<const SceneGeometry> geometry = {});

/// Area of the kept sides in m^2; a polygon of which both are kept counts twice.
double kept_area(const Scene& scene, const KeptSides& sides);

}  // namespace patchlight
