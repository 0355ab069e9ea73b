#pragma once

#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"

#include "cli/arguments.h"

#include <filesystem>
#include <optional>
#include <string>

namespace patchlight::cli {

/// The camera that is asked for, else the first of the scene, in meters; nothing when there is none. \throws InputError
/// when the scene has no camera of that name.
std::optional<Camera> camera_for(const PictureSettings& settings, const Scene& scene);

/// \throws InputError when that camera lies too far from the scene.
void require_camera_in_reach(const PictureSettings& settings, const Scene& scene);

/// The picture that is asked for. \throws Cancelled.
Picture make_picture(const PictureSettings& settings, const Scene& scene, const Simulation& simulation,
                     const Observer& observer);

/// A sentence with the error of a finished picture and a remedy, where the error is more than a tenth above the one
/// that is asked for.
std::optional<std::string> missed_error(const PictureSettings& settings, const Picture& picture);

/// Writes it, with a legend where its colors are false. \throws OutputError.
void write_picture_file(const std::filesystem::path& file, const Picture& picture, const Scene& scene);

}  // namespace patchlight::cli
