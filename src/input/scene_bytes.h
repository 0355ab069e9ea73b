#pragma once

#include "patchlight/scene/scene.h"

#include <string>
#include <string_view>

namespace patchlight {

/// A scene as bytes, for another process of this program on this machine: vertices, polygons, materials, groups, notes,
/// problems without their faces, checksum, unit and upright direction.
std::string scene_bytes(const Scene& scene);

/// The scene that scene_bytes() turned into these bytes. \throws std::runtime_error when they are not such bytes.
Scene scene_from_bytes(std::string_view bytes);

}  // namespace patchlight
