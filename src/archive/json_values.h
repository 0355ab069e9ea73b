#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace patchlight {

/// Keeps the keys in the order in which they are set.
using Json = nlohmann::ordered_json;

/// A text; as an array of its bytes when it is not UTF-8, which JSON cannot hold.
Json json_of(const std::string& text);
Json json_of(const std::vector<std::string>& texts);
Json json_of(const Spectrum& spectrum);
Json json_of(const Vector& vector);

/// The same back. \throws what nlohmann::json throws where a part is missing or of another shape; so do all below.
std::string text_of(const Json& json);
std::vector<std::string> texts_of(const Json& json);
Spectrum spectrum_of(const Json& json);
Vector vector_of(const Json& json);

/// \throws std::out_of_range with the message `otherwise` if the condition is false.
void require(bool condition, const std::string& otherwise);

}  // namespace patchlight
