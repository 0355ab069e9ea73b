#include "page/packed.h"

#include <cstdint>
#include <new>
#include <stdexcept>
#include <zlib.h>

namespace patchlight {
namespace {

std::string by_planes(std::string_view bytes, std::size_t width) {
  const std::size_t count = bytes.size() / width;
  std::string planes(bytes.size(), '\0');
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t byte = 0; byte < width; ++byte) planes[byte * count + k] = bytes[k * width + byte];
  }
  return planes;
}

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  const int error = compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                              bytes.size(), Z_DEFAULT_COMPRESSION);
  // With as much room as zlib wants, nothing else can be wrong.
  if (error != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
    std::uint32_t group = 0;
    for (std::size_t byte = 0; byte < 3; ++byte)
      group = group << 8 | (byte < count ? static_cast<std::uint8_t>(bytes[k + byte]) : 0U);
    for (std::size_t letter = 0; letter < 4; ++letter)
      text += letter <= count ? letters[group >> (18 - 6 * letter) & 63U] : '=';
  }
  return text;
}

std::string packed_text(std::string_view bytes, std::size_t width) { return base64(deflated(by_planes(bytes, width))); }

}  // namespace patchlight
