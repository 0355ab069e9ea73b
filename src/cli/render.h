#pragma once

#include "patchlight/simulate.h"
#include "patchlight/views/picture.h"

#include "cli/arguments.h"

#include <filesystem>
#include <optional>
#include <string>

namespace patchlight::cli {

/// The camera that is asked for, else the first of the scene, in metres; nothing when there is none. \throws InputError
/// when the scene has no camera of that name.
std::optional<Camera> camera_for(const PictureSettings& settings, const Scene& scene);

/// The picture that is asked for. \throws Cancelled.
Picture make_picture(const PictureSettings& settings, const Scene& scene, const Simulation& simulation,
                     const Observer& observer);

/// A sentence that tells the error of a finished picture and how to mend it, where it is more than a tenth above the
/// one that is asked for.
std::optional<std::string> missed_error(const PictureSettings& settings, const Picture& picture);

/// Writes it, with a legend where its colours are false. \throws OutputError.
void write_picture_file(const std::filesystem::path& file, const Picture& picture, const Scene& scene);

/// Writes the errors of its pixels. \throws OutputError.
void write_error_map(const std::filesystem::path& file, const Picture& picture);

}  // namespace patchlight::cli
