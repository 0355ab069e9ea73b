#pragma once

#include "patchlight/scene/scene.h"

#include <vector>

namespace patchlight {

/// Per room of the scene the area of the clear faces, both sides of a pane of glass each, that have it before them or
/// behind them, and no room on their other side, within half a metre, as panes may stand in the thick of a wall; m^2.
/// O(openings x corners of the rooms).
std::vector<double> window_areas(const Scene& scene);

}  // namespace patchlight
