#pragma once

#include "patchlight/plan/plan.h"

#include <optional>
#include <string>

namespace patchlight {

/// What one part of a request says against another, whatever the scene is like. Messages name fields as
/// "accuracy.relative_error", with the value where that is what counts: "effects.skip=sun".
/// \throws InputError when parts of the request cannot be together.
void check(const Request& request, const Given& given = {});

/// The same, and what the scene does not have. \throws InputError as well when nothing in it has a name of
/// AccuracyOptions::interest.
void check(const Request& request, const Scene& scene, const Given& given = {});

/// What of a request leaves no error bars, as messages name it; nothing where there may be some.
std::optional<std::string> part_without_error_bars(const Request& request, const Given& given = {});

}  // namespace patchlight
