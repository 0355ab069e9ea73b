#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight {

/// The scene with walls opened where clear faces lie over them in one plane, as a pane that is drawn on an uncut wall:
/// over it by the order of find_coverings(). The part under the clear face is cut out, as a hole with a seam where the
/// clear face lies within the wall's outline, so that both form a closed surface, else in convex pieces. The faces that
/// are cut are reported as overlapping_faces. Vertices have to be welded.
Scene with_openings_cut(Scene scene);

/// The scene with each pane that is modeled as a solid counted once. A pane has two sides that face away from each
/// other, at most 5 cm and a tenth of their size apart. They are parallel, of one material that does not emit, and lie
/// opposite each other over 96 % of each face, however the sides are cut into faces. The side with the first face gets
/// its material on both sides, and the other one lets all light through. A face goes with the nearest faces opposite
/// it. A face with a material on its back is a sheet already. A note gives the number of panes. Sides that lie opposite
/// each other in part count face by face. O(n log n + k) for n clear faces of which k pairs are near each other.
Scene with_solid_panes_as_one(Scene scene);

}  // namespace patchlight
