#pragma once

#include <cstddef>
#include <cstring>
#include <gtest/gtest.h>
#include <string>

namespace patchlight::test {

/// A number in the bytes of a binary file.
template <class Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number number{};
  EXPECT_LE(offset + sizeof number, bytes.size());
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

}  // namespace patchlight::test
