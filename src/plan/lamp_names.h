#pragma once

#include <string>

namespace patchlight {

/// True when a word of the name is one for a lamp: "ceiling_light", "FloorLamp 2", "Deckenleuchte". Words end at
/// letters that are none, at digits, and where a capital follows a small letter. "Lightweight" is another word, and
/// "light grey" a colour.
bool is_name_of_lamp(const std::string& name);

}  // namespace patchlight
