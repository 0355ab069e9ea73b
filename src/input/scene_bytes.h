#pragma once

#include "patchlight/scene/scene.h"

#include "files/isolated.h"

#include <functional>
#include <string>
#include <string_view>

namespace patchlight {

/// Serializes a scene for another process of this program on this machine: vertices, polygons, materials, groups,
/// diagnostics without faces, checksum, unit and vertical axis.
std::string scene_bytes(const Scene& scene);

/// The inverse of scene_bytes(). \throws std::runtime_error for invalid bytes.
Scene scene_from_bytes(std::string_view bytes);

/// Runs `read` in a child process under the limits of bytes_isolated(), and returns its scene. \throws InputError.
Scene read_isolated(const std::string& file, const std::function<Scene()>& read, const ChildLimits& limits = {});

}  // namespace patchlight
