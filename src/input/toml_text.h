#pragma once

#include "patchlight/base/geometry.h"

#include <string>

namespace patchlight {

/// A text as a string of a TOML file; control characters become question marks.
std::string toml_text(const std::string& text);

/// A point as a list of a TOML file, "[1, 2.5, 0]", to a thousandth.
std::string toml_text(const Point& point);

}  // namespace patchlight
