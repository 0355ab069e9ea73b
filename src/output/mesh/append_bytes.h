#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <string>

namespace patchlight {

/// Appends a number as it stands in memory, least significant byte first.
template <class Number>
requires std::integral<Number> || std::floating_point<Number>
void append_bytes(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little, "the formats written are little endian");
  const auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(number);
  bytes.append(raw.data(), raw.size());
}

}  // namespace patchlight
