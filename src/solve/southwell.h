#pragma once

#include "solve/iterations.h"

namespace patchlight {

/// How much a patch shoots: what is unshot, or also its share of what is still under way to it.
enum class Shot { unshot, overshot };

/// Progressive refinement: the lamps shoot first, then the patch with the most unshot flux, again and again. With a
/// limit of rows, SolverOptions::max_rows, a patch of each group of CoarseTransport shoots before, so that a first
/// picture is known roughly everywhere. Cohen, Chen, Wallace and Greenberg 1988; it is Southwell relaxation of the same
/// system (Gortler, Cohen and Slusallek 1994). Overshooting (Feda and Purgathofer 1992) shoots beforehand what is
/// expected to come, and a little more than what is unshot: over-relaxation. docs/theory/progressive-refinement.md.
/// Takes single rows of the transport. An iteration's number is that of its shots.
Solution progressive_refinement(Iterations iterations, const RowTransport& transport, Shot shot);

}  // namespace patchlight
