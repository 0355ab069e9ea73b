#pragma once

#include "validate/validate.h"

#include <vector>

namespace patchlight::validation {

/// Rectangles opposed, at a right angle, and sharing an edge at other angles; elements and rectangles.
std::vector<ValidationCase> rectangle_cases();

/// Discs, spheres and cylinders, by polygons and polyhedra.
std::vector<ValidationCase> curved_cases();

/// Rooms solved as a whole.
std::vector<ValidationCase> solved_cases();

}  // namespace patchlight::validation
