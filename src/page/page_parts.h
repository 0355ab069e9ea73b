#pragma once

#include <string_view>

namespace patchlight {

/// The page without its title and its data, which take the places of @TITLE@ and @DATA@. It is put together by
/// cmake/page.cmake when the library is built.
std::string_view page_template();

/// three.js and its controls.
std::string_view page_scripts();

}  // namespace patchlight
