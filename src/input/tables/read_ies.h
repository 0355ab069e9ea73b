#pragma once

#include "scene/photometric_web.h"

#include <filesystem>
#include <string>

namespace patchlight {

/// Reads a photometric file, IES LM-63 of 1986, 1991, 1995 or 2002: types A, B and C, TILT=NONE or INCLUDE, relative
/// and absolute photometry, dimensions in feet or metres. The candela are multiplied by the file's multiplier, its
/// ballast factor and its ballast-lamp factor. \throws InputError naming the file and line.
PhotometricWeb read_ies(const std::filesystem::path& file);

/// The same from a text; `file` is for messages.
PhotometricWeb parse_ies(const std::string& text, const std::string& file);

}  // namespace patchlight
