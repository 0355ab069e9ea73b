#pragma once

#include <exception>
#include <filesystem>
#include <string>

namespace patchlight {

/// \throws InputError when the file exists and is a folder, pipe or device, since reading these may block or never end.
/// A missing file passes.
void require_regular_file(const std::filesystem::path& file);

/// The reason of a library for refusing a file, as one line for the user. Texts that name only internal types and
/// functions ("std::bad_alloc", "vector::_M_range_check", "[json.exception.type_error.302]") are replaced by the
/// corresponding fault of the file.
std::string reason_of(const std::exception& error);

/// The same for an error text returned by a library.
std::string reason_of(const std::string& library_text);

}  // namespace patchlight
