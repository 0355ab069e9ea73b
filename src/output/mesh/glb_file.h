#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/scene/scene.h"

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace patchlight {

/// Numbers of the glTF 2.0 specification.
namespace gltf {
inline constexpr int type_float = 5126, type_unsigned_short = 5123, type_unsigned_int = 5125;
inline constexpr int target_vertices = 34962, target_indices = 34963;
inline constexpr int linear_filter = 9729, clamp_to_edge = 33071;
}  // namespace gltf

/// glTF's y points up: of a scene whose z does, (x, y, z) becomes (x, z, -y).
Vector y_up(const Vector& vector, const Scene& scene);

/// Writes a binary glTF of a description and the one buffer that it names, padded as the format wants. \throws
/// OutputError, also when the file would exceed the format's 4 GiB.
void write_glb_file(const std::filesystem::path& file, const nlohmann::ordered_json& description,
                    const std::string& buffer);

}  // namespace patchlight
