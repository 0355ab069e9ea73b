#include "page/drawn_faces.h"

#include <cstdint>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <vector>
#include <zlib.h>

namespace patchlight::packed_test {
namespace {

// RFC 4648, section 10.
TEST(Base64, HasTheLettersOfItsSpecification) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\xfe\xfb\x00", 4)), "//77AA==");
}

std::string from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(letter));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255U);
  }
  return bytes;
}

// The decoding of the page: inflate, then take the bytes of each number out of the planes.
template <class Number>
std::vector<Number> unpacked(const std::string& text, std::size_t count) {
  const std::string packed = from_base64(text);
  std::string planes(count * sizeof(Number), '\0');
  uLongf size = planes.size();
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(planes.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                       packed.size()),
            Z_OK);
  EXPECT_EQ(size, planes.size());
  std::vector<Number> numbers(count);
  for (std::size_t k = 0; k < count; ++k) {
    char bytes[sizeof(Number)];
    for (std::size_t byte = 0; byte < sizeof(Number); ++byte) bytes[byte] = planes[byte * count + k];
    std::memcpy(&numbers[k], bytes, sizeof(Number));
  }
  return numbers;
}

TEST(PackedArray, KeepsEveryBit) {
  const std::vector<float> values = {0, -1.5F, 1e-40F, 3.4e38F, std::numeric_limits<float>::infinity(), 0.1F};
  const auto part = packed_array<float>(values, 3);
  EXPECT_EQ(part["type"], "f4");
  EXPECT_EQ(part["components"], 3);
  EXPECT_EQ(unpacked<float>(part["packed"], values.size()), values);
}

TEST(PackedArray, TakesNoNumbersAtAll) {
  EXPECT_EQ(unpacked<std::uint32_t>(packed_array<std::uint32_t>({}, 1)["packed"], 0), std::vector<std::uint32_t>{});
}

}  // namespace
}  // namespace patchlight::packed_test
