#pragma once

#include "patchlight/base/diagnostics.h"

#include <nlohmann/json.hpp>

namespace patchlight {

/// The values in their order. Numbers that are not finite are written as null.
template <class Values>
nlohmann::ordered_json json_array(const Values& values) {
  auto array = nlohmann::ordered_json::array();
  for (const auto& value : values) array.push_back(value);
  return array;
}

/// Diagnostics as objects with their code, severity and text.
inline nlohmann::ordered_json json_of(const Diagnostics& diagnostics) {
  auto array = nlohmann::ordered_json::array();
  for (const Diagnostic& found : diagnostics)
    array.push_back(
        {{"code", name_of(found.code)}, {"severity", name_of(severity_of(found.code))}, {"text", found.text}});
  return array;
}

}  // namespace patchlight
