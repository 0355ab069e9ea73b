#pragma once

#include "archive/form_factor_files.h"
#include "pipeline/ray_form_factors.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// Writes a folder of rows of rays, whole or not at all: for both halves of the rays sparse rows, the lamps that are
/// apart with their form factors, area.npy, lost_share.npy, hit_distance.npy, mesh.vtp, scene.json, info.json.
/// docs/reference/outputs/form-factor-folder.md describes them. \throws OutputError, Cancelled.
void write_ray_rows(const std::filesystem::path& folder, const Scene& scene, const RayFormFactors& found,
                    const std::string& command_line, const Observer& observer = {});

/// Reads the rows of this mesh. \throws InputError when they belong to another one, or are none: every row has to sum
/// up to what its patch sees.
RayExchange read_ray_rows(const std::filesystem::path& folder, const FormFactorInfo& info, const PatchMesh& mesh);

}  // namespace patchlight
