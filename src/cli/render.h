#pragma once

#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"

#include "cli/arguments.h"

#include <filesystem>
#include <optional>
#include <string>

namespace patchlight::cli {

/// The requested camera, else the first of the scene, in meters; empty if there is none. \throws InputError when the
/// scene has no camera of that name.
std::optional<Camera> camera_for(const PictureSettings& settings, const Scene& scene);

/// \throws InputError when that camera is too far from the scene.
void require_camera_in_reach(const PictureSettings& settings, const Scene& scene);

/// Renders the requested image. \throws `Canceled`.
Picture make_picture(const PictureSettings& settings, const Scene& scene, const Simulation& simulation,
                     const Observer& observer);

/// A message with the error of a finished image and a remedy, if the error exceeds the requested one by more than 10 %.
std::optional<std::string> missed_error(const PictureSettings& settings, const Picture& picture);

/// Writes the image, with a legend for false colors. \throws OutputError.
void write_picture_file(const std::filesystem::path& file, const Picture& picture, const Scene& scene);

}  // namespace patchlight::cli
