#pragma once

#include <exception>
#include <string>

namespace patchlight {

/// The reason of an exception of a library, in one line for the user of a file. Names of the library are left out
/// ("[json.exception.type_error.302]", "std::bad_alloc", "vector::_M_range_check").
std::string reason_of(const std::exception& error);

}  // namespace patchlight
