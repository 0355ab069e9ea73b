#pragma once

#include "patchlight/scene/scene.h"

#include "files/isolated.h"

#include <functional>
#include <string>
#include <string_view>

namespace patchlight {

/// A scene as bytes, for another process of this program on this machine: vertices, polygons, materials, groups,
/// diagnostics without their faces, checksum, unit and upright direction.
std::string scene_bytes(const Scene& scene);

/// The scene that scene_bytes() turned into these bytes. \throws std::runtime_error when they are not such bytes.
Scene scene_from_bytes(std::string_view bytes);

/// The scene that `read` returns in a child process, under the limits of bytes_isolated(). \throws InputError.
Scene read_isolated(const std::string& file, const std::function<Scene()>& read, const ChildLimits& limits = {});

}  // namespace patchlight
