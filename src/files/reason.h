#pragma once

#include <exception>
#include <string>

namespace patchlight {

/// The reason that an exception of a library gives, in one line for the user of a file, without the names of the library
/// ("[json.exception.type_error.302]", "std::bad_alloc", "vector::_M_range_check").
std::string reason_of(const std::exception& error);

}  // namespace patchlight
