#pragma once

#include <cairo.h>
#include <filesystem>
#include <functional>

namespace patchlight {

/// Writes a drawing of so many pixels, by the extension of the file: .svg or .png. The same bytes on every run.
/// \throws OutputError.
void write_drawing(const std::filesystem::path& file, int width, int height, const std::function<void(cairo_t*)>& draw);

}  // namespace patchlight
