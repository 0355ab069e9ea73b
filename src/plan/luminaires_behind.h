#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <vector>

namespace patchlight {

/// A sentence for each luminaire that lies up to 1 mm behind an opaque face towards which it shines, but not in its
/// plane: its light falls on the side that is not meant, as on the roof when it is a little over the ceiling. And for
/// each that shines in all directions from the plane of an opaque face: half of its light goes to either side.
std::vector<std::string> notes_on_luminaires_behind(const Scene& scene);

}  // namespace patchlight
