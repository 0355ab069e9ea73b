#pragma once

#include "patchlight/scene/scene.h"

#include "files/isolated.h"

#include <functional>
#include <string>

namespace patchlight {

/// Runs `read` in a child process under the limits of bytes_isolated(), and returns its scene: vertices, polygons,
/// materials, groups, rooms, diagnostics without faces, checksum, unit and vertical axis. \throws InputError.
Scene read_isolated(const std::string& file, const std::function<Scene()>& read, const ChildLimits& limits = {});

}  // namespace patchlight
