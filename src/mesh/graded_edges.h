#pragma once

#include "patchlight/scene/sides.h"

#include "mesh/outline.h"

#include <vector>

namespace patchlight {

/// The same outlines, where those that become grids of quadrilaterals know towards which of their edges patches shrink:
/// edges that they share with a face they see there at less than 150 degrees (docs/theory/edges-and-contacts.md). Faces
/// that go on smoothly over a common edge have the same points there: where one of them cannot shrink its patches along
/// that edge, the other does not. O(n log n) for n edges, and O(n) for every face of a strip along which that goes on.
std::vector<Outline> graded(std::vector<Outline> outlines, const KeptSides& sides);

}  // namespace patchlight
