#pragma once

#include "mesh/lattice.h"

#include <span>
#include <vector>

namespace patchlight {

/// The same lines cut wherever they meet, each once: those that are nearer than the width of a square grid become one
/// (snap rounding; Hobby 1999). Their ends lie on the lines themselves but for rounding, or, where these cross at a
/// narrow angle, within that width of them. In the order of their ends. Nothing where lines_on_grid() gives nothing.
std::vector<FlatLine> noded_lines(std::span<const FlatLine> lines, double grid);

/// The same lines, each once, with fewer corners where they bend: none is farther than `tolerance` from what it was,
/// and what is smaller than `least_size`, with all that hangs together with it, is left out.
std::vector<FlatLine> simplified_lines(std::span<const FlatLine> lines, double grid, double tolerance,
                                       double least_size);

/// The lines at a distance from these, which meet in their ends alone, to both sides of them, without the parts
/// whose middles are nearer to any. O(n^2).
std::vector<FlatLine> lines_beside(std::span<const FlatLine> lines, double grid, double distance);

}  // namespace patchlight
