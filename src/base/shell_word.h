#pragma once

#include <string>

namespace patchlight {

/// A word as one would type it in a POSIX shell: in single quotes unless it consists of letters, digits and signs of
/// ASCII that no shell takes for anything else.
std::string shell_word(const std::string& word);

}  // namespace patchlight
