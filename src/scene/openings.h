#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with walls opened where clear faces lie over them in one plane, as a pane that is drawn on an uncut wall:
/// over it by the order of find_coverings(). What lies under the clear face is cut out, as a hole with a seam where the
/// clear face lies within the wall's outline, so that both form a closed surface, else in convex pieces. The faces that
/// are cut are reported as overlapping_faces. Vertices have to be welded.
Scene with_openings_cut(Scene scene);

}  // namespace patchlight
