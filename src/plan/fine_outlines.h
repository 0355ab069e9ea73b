#pragma once

#include "patchlight/scene/scene.h"
#include "patchlight/scene/sides.h"

#include <cstddef>
#include <string>
#include <vector>

namespace patchlight {

/// What is worth saying of outlines that are finer than patches, in a mesh with edges of at most `max_edge` metres: of
/// which faces patches follow a coarser outline; and which take a quarter of the `asked` patches or more for their
/// corners alone, 0 standing for no such number.
std::vector<std::string> notes_on_fine_outlines(const Scene& scene, const KeptSides& sides, std::size_t asked,
                                                double max_edge);

}  // namespace patchlight
