#pragma once

#include "patchlight/views/views.h"

#include <filesystem>
#include <span>

namespace patchlight {

/// Writes what observers read (.csv), a line for each: name, vertical and cylindrical illuminance in lx, background
/// luminance in cd/m^2, solid angle of what glares in sr, and UGR, empty where nothing does. \throws OutputError.
void write_observers(const std::filesystem::path& file, std::span<const ObserverReading> observers);

}  // namespace patchlight
