#pragma once

#include "patchlight/scene/scene.h"

#include <cstdint>
#include <string>
#include <vector>

namespace patchlight {

/// Which sides of the polygons take part.
enum class Sides {
  automatic,  ///< all but those that face the inside of a closed solid without a lamp, or the dark outside of a closed
              ///< shell
  front,      ///< the front sides only; of polygons whose back is a face of its own both
  both        ///< both sides of every polygon
};

/// "auto", "front" or "both", as on the command line.
const char* name_of(Sides sides);

/// The sides that become patches, per polygon.
struct KeptSides {
  std::vector<std::uint8_t> front;  ///< 1 when the polygon's front side is kept
  std::vector<std::uint8_t> back;   ///< 1 when its back side is kept
  bool emit_from_back = false;      ///< lamps emit from their back sides too (Sides::both)
  std::vector<std::string> notes;   ///< what was decided, for the report
};

/// Chooses the sides. A solid is a closed shell (scene/shells.h) with a volume; polygons of it that are turned against
/// the others are seen as if turned back. A solid holds a lamp when a point just before an emitting side of a polygon
/// has winding number +-1 in it, or a luminaire's position has. Sun and sky shine from outside, and light gets in
/// through clear openings.
///
/// Sides::automatic keeps a side unless
/// - it faces the inside of a closed solid that holds no lamp and has no opening to one outside, or
/// - it faces the outside of a closed solid that holds every lamp of the scene: no light gets there.
/// So the inner sides of a closed room are used even when its normals point outward; a note says so.
KeptSides kept_sides(const Scene& scene, Sides sides);

/// Area of the kept sides in m^2; a polygon of which both are kept counts twice.
double kept_area(const Scene& scene, const KeptSides& sides);

}  // namespace patchlight
