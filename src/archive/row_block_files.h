#pragma once

#include "patchlight/scene/scene.h"

#include "transport/ray_rows.h"
#include "transport/row_blocks.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// What rows of rays depend on, as 16 hexadecimal digits of a SHA-256: this version, the faces of the scene and what
/// they let through, the patches, and how rays are sent.
std::string row_key(const Scene& scene, const PatchMesh& mesh, const RayOptions& options,
                    std::span<const float> bright_densities);

/// Blocks of rows as files of a folder, which must be there: rows_<key>_<block>.npy, each of them whole or not there.
/// Files that are damaged, or longer or shorter than they have to be, count as not there. Reading and keeping throw
/// OutputError, where a file cannot be written.
RowBlocks row_blocks_in(const std::filesystem::path& folder, const std::string& key);

/// Removes the files of these keys, and the folder when nothing else is in it. What cannot be removed stays.
void remove_row_blocks(const std::filesystem::path& folder, const std::vector<std::string>& keys);

}  // namespace patchlight
