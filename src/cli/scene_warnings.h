#pragma once

#include "patchlight/scene/scene.h"

namespace patchlight::cli {

/// Prints a warning on stderr for each problem that can make all results wrong. Commands call it before the work
/// begins, also when they are quiet.
void print_scene_warnings(const Scene& scene);

}  // namespace patchlight::cli
