#pragma once

#include <nlohmann/json.hpp>

namespace patchlight {

/// The values in their order. Numbers that are not finite are written as null.
template <class Values>
nlohmann::ordered_json json_array(const Values& values) {
  auto array = nlohmann::ordered_json::array();
  for (const auto& value : values) array.push_back(value);
  return array;
}

}  // namespace patchlight
