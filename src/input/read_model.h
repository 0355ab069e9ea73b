#pragma once

#include "patchlight/scene/scene.h"

#include "input/radiance/radiance_modifiers.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// A model file as it stands, and the modifiers that it leaves to later Radiance files.
struct FileModel {
  Scene scene;
  RadianceModifiers modifiers;
};

/// The format of a file: its extension in lower case, without the dot, or that of which it is another name; the
/// standard input is OBJ.
std::string format_of(const std::filesystem::path& file);

/// \throws InputError at `where` unless the file is there and no folder. "-" always is. `near_names` lets the message
/// name a file of that folder which may be meant.
void require_file(const std::filesystem::path& file, const std::string& where, bool near_names = false);

/// One model file as it stands, in metres, before any setting or check. `format` is one of readable_formats() without
/// toml. `metres_per_unit` is used instead of the unit that the file states, if it is given. The file, and those that
/// it names, must lie in the folder `confine`, if there is one. `known` has the modifiers of files before it. \throws
/// InputError.
FileModel read_model(const std::filesystem::path& file, const std::string& format,
                     std::optional<double> metres_per_unit, const std::filesystem::path& confine,
                     RadianceModifiers known);

}  // namespace patchlight
