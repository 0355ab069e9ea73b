#pragma once

#include <exception>
#include <filesystem>
#include <string>

namespace patchlight {

/// Reading anything else may wait without an end, or have none. \throws InputError when a file is there that is a
/// folder, a pipe or a device; of one that is not there nothing is said.
void require_regular_file(const std::filesystem::path& file);

/// The reason that a library gives for refusing a file, in one line for the user of the file. Texts that only name the
/// library's own types and functions ("std::bad_alloc", "vector::_M_range_check", "[json.exception.type_error.302]")
/// are replaced by the fault of the file that causes them.
std::string reason_of(const std::exception& error);

/// The same for a text that a library returns instead of throwing.
std::string reason_of(const std::string& library_text);

}  // namespace patchlight
