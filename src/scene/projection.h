#pragma once

#include "patchlight/scene/scene.h"

#include <optional>
#include <string>

namespace patchlight {

/// That of name_of(); nothing for other names.
std::optional<Projection> projection_named(const std::string& name);

/// The vertical field of view of a camera of which none is stated, degrees.
double usual_field_of_view(Projection projection);

/// The largest vertical field of view, degrees: a perspective stays below it.
double largest_field_of_view(Projection projection);

/// False when a camera's field of view, or the height of an orthographic one, is none that its projection can have.
bool has_extent(const Camera& camera);

}  // namespace patchlight
