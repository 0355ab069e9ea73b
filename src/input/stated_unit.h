#pragma once

#include <string_view>

namespace patchlight {

/// Metres per unit of a COLLADA text: the attribute meter of its first <unit>; 1 without one.
double collada_unit(std::string_view text);

/// Metres per unit of length of an IFC text: its SI prefix with METRE, or FOOT or INCH by conversion; 1 without one.
double ifc_unit(std::string_view text);

}  // namespace patchlight
