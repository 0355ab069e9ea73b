#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace patchlight {

/// Base64 (RFC 4648, section 4).
std::string base64(std::string_view bytes);

/// Numbers of `width` bytes each as text: first the lowest byte of all, then the next, so that bytes that are alike
/// stand together; deflated in the format of zlib (RFC 1950), in base64.
std::string packed_text(std::string_view bytes, std::size_t width);

/// An array for the page: {"type": "f4", "components": 3, "packed": text}. Types are u1, u2, u4 and f4, little endian.
template <class Number>
nlohmann::ordered_json packed_array(std::span<const Number> values, std::size_t components) {
  const char kind = std::is_floating_point_v<Number> ? 'f' : 'u';
  const std::string_view bytes{reinterpret_cast<const char*>(values.data()), values.size_bytes()};
  return {{"type", std::string(1, kind) + std::to_string(sizeof(Number))},
          {"components", components},
          {"packed", packed_text(bytes, sizeof(Number))}};
}

}  // namespace patchlight
