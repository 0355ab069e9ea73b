#pragma once

#include "mesh/lattice.h"

#include <cstddef>
#include <span>
#include <vector>

namespace patchlight {

/// A part of a line between two places of a grid.
struct PartOnGrid {
  FlatLine ends;
  std::size_t line = 0;  ///< which line it is a part of
};

/// The same lines with their ends on a square grid, cut wherever they meet there: those that are nearer than the width
/// of the grid lie on each other (snap rounding; Hobby 1999), a part for each. In the order of their ends. Nothing
/// where one reaches farther than 5e8 widths from the origin.
std::vector<PartOnGrid> lines_on_grid(std::span<const FlatLine> lines, double width);

}  // namespace patchlight
