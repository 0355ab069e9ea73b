#pragma once

#include "patchlight/plan/effects.h"
#include "patchlight/scene/scene.h"

#include "archive/form_factor_files.h"
#include "pipeline/form_factors.h"
#include "transport/ray_rows.h"

#include <filesystem>
#include <span>
#include <string>

namespace patchlight {

/// The inputs of rows of rays besides the patches and the options of rays.
struct RowScene {
  const Scene& scene;
  EffectOptions effects;  ///< asked for: whether anything is in the way of rays
};

/// 16 hexadecimal digits of a SHA-256 of everything that rows depend on: the faces and their transmittance, the
/// patches, the ray settings, and the version of the row algorithm.
std::string row_key(const RowScene& of, const PatchMesh& mesh, const RayOptions& options,
                    std::span<const float> bright_densities);

/// Blocks of rows as files rows_<key>_<block>.npy of a folder, which is made where it is missing: each of them whole or
/// not there, with a digest at its end. Files that cannot be read, or whose digest is another one, count as not there.
/// keep() throws OutputError where a file cannot be written.
RowBlocks row_blocks_in(const std::filesystem::path& folder, const std::string& key);

/// Removes the files of these keys. Files that cannot be removed stay.
void remove_row_blocks(const std::filesystem::path& folder, std::span<const std::string> keys);

/// Writes a folder of rows of rays, whole or not at all: for both halves of the rays sparse rows, the lamps that are
/// apart with their form factors, area.npy, lost_share.npy, hit_distance.npy, mesh.vtp, scene.json, info.json.
/// docs/reference/outputs/form-factor-folder.md describes them. \throws OutputError, Canceled.
void write_ray_rows(const std::filesystem::path& folder, const Scene& scene, const RayFormFactors& found,
                    const std::string& command_line, const Observer& observer = {});

/// Reads the rows of this mesh. \throws InputError when they belong to another one, or are none: every row has to sum
/// up to what its patch sees.
RayExchange read_ray_rows(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh);

}  // namespace patchlight
