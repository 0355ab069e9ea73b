#pragma once

#include "patchlight/scene/scene.h"

#include <filesystem>

namespace patchlight {

/// Reads an XML file by its first element: <scene> is a Mitsuba scene, <gbXML> a building. \throws InputError naming
/// the file and the line.
Scene read_xml(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

}  // namespace patchlight
