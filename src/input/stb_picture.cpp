#include "input/stb_picture.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stb/stb_image.h>
#include <utility>

namespace patchlight {
namespace {

enum class PictureFormat { png, jpeg, bmp, hdr, tga, unknown };

// A TGA has no signature: its second byte tells whether it has a palette. JPEG 2000, AVIF and ICO have a 0 there as
// well, but no image type of a TGA in the third byte, by which stb_image refuses them.
PictureFormat format_of_picture(std::string_view bytes) {
  constexpr std::size_t tga_header = 18;
  if (bytes.starts_with("\x89PNG")) return PictureFormat::png;
  if (bytes.starts_with("\xFF\xD8\xFF")) return PictureFormat::jpeg;
  if (bytes.starts_with("BM")) return PictureFormat::bmp;
  if (bytes.starts_with("#?RADIANCE\n") || bytes.starts_with("#?RGBE\n")) return PictureFormat::hdr;
  const bool may_be_tga = bytes.size() >= tga_header && static_cast<unsigned char>(bytes[1]) <= 1;
  return may_be_tga ? PictureFormat::tga : PictureFormat::unknown;
}

// The bytes as stb_image reads them, which notice whether it wants more than there are: it goes on with zeros. Where
// these would keep it for ever, as a run of length 0 does in Radiance's pictures, it gets 0xFF instead.
class PictureBytes {
 public:
  PictureBytes(std::string_view bytes, bool goes_on) : bytes_(bytes), goes_on_(goes_on) {}

  bool is_cut_off() const { return is_cut_off_; }
  static stbi_io_callbacks callbacks() {
    return {[](void* self, char* to, int size) { return static_cast<PictureBytes*>(self)->read(to, size); },
            [](void* self, int size) { static_cast<PictureBytes*>(self)->skip(size); },
            [](void* self) { return static_cast<int>(static_cast<PictureBytes*>(self)->is_at_end()); }};
  }

 private:
  // stb_image reads ahead into a block, which is the first that it fills, and asks for all that it needs otherwise.
  int read(char* to, int size) {
    if (!block_) block_ = to;
    const std::size_t asked = static_cast<std::size_t>(std::max(size, 0));
    const std::size_t found = std::min(asked, bytes_.size() - at_);
    if (found > 0) std::memcpy(to, bytes_.data() + at_, found);
    at_ += found;
    const bool is_enough = found == asked || (to == block_ && found > 0);
    if (is_enough) return static_cast<int>(found);
    is_cut_off_ = true;
    if (!goes_on_) return static_cast<int>(found);
    std::memset(to + found, 0xFF, asked - found);
    return size;
  }
  void skip(int size) { at_ += std::min(static_cast<std::size_t>(std::max(size, 0)), bytes_.size() - at_); }
  bool is_at_end() const { return at_ == bytes_.size(); }

  std::string_view bytes_;
  bool goes_on_;
  const char* block_ = nullptr;
  std::size_t at_ = 0;
  bool is_cut_off_ = false;
};

PicturePixels with_fault(std::string fault) {
  PicturePixels none;
  none.fault = std::move(fault);
  return none;
}

constexpr const char* unknown_format = "is neither PNG, JPEG, BMP, TGA nor Radiance HDR";

std::string fault_of(PictureFormat format, const PictureBytes& bytes) {
  if (!bytes.is_cut_off()) return "cannot be decoded; is it whole?";
  // stb_image takes a run of the old kind, (1, 1, 1, length), for a pixel, and misses those that it stands for.
  if (format == PictureFormat::hdr) return "has runs of the old kind, or is cut off";
  return format == PictureFormat::tga ? "is cut off, if it is a TGA" : "is cut off";
}

constexpr const char* too_large = "has more than 8192 x 8192 pixels";

// stb_image refuses sizes beyond its own limits as if it did not know the format; its readers tell, at the header.
bool is_beyond_limits(std::string_view picture) {
  const stbi_io_callbacks callbacks = PictureBytes::callbacks();
  PictureBytes bytes(picture, false);
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<unsigned char[], FreeMemory> codes(
      stbi_load_from_callbacks(&callbacks, &bytes, &width, &height, &channels, 0));
  return !codes && std::strcmp(stbi_failure_reason(), "too large") == 0;
}

// A few hundred bytes can stand for very many pixels. Width, height and channels as the header states them; a fault
// where it cannot be read or they are too many.
PicturePixels stated_size(PictureFormat format, std::string_view picture) {
  const stbi_io_callbacks callbacks = PictureBytes::callbacks();
  PictureBytes bytes(picture, false);
  int width = 0;
  int height = 0;
  int channels = 0;
  if (!stbi_info_from_callbacks(&callbacks, &bytes, &width, &height, &channels)) {
    if (format == PictureFormat::tga) return with_fault(unknown_format);
    const bool may_be_large = format == PictureFormat::png || format == PictureFormat::jpeg;
    return with_fault(may_be_large && is_beyond_limits(picture) ? too_large : fault_of(format, bytes));
  }
  // A BMP that runs downwards states a negative height.
  const std::uint64_t columns = static_cast<std::uint64_t>(std::max(width, 0));
  const auto rows = static_cast<std::uint64_t>(std::abs(std::int64_t{height}));
  if (columns * rows == 0) return with_fault(fault_of(format, bytes));
  constexpr std::uint64_t most = std::uint64_t{8192} * 8192;
  if (columns * rows > most) return with_fault(too_large);
  if (format == PictureFormat::hdr && columns * rows > most / 2)
    return with_fault("has more than 4096 x 8192 pixels, the most of a Radiance HDR");
  PicturePixels size;
  size.width = columns;
  size.height = rows;
  return size;
}

// Some programs write a fourth byte that the header says means nothing: that of a TGA in bits 0 to 3 of its last byte,
// that of a BMP by the compression BI_RGB, 0, in the fourth word of the BITMAPINFOHEADER behind the first 14 bytes.
bool alpha_means_something(PictureFormat format, std::string_view picture) {
  if (format == PictureFormat::tga) return (static_cast<unsigned char>(picture[17]) & 0xFU) != 0;
  return format != PictureFormat::bmp || picture.substr(30, 4) != std::string_view("\0\0\0\0", 4);
}

}  // namespace

PicturePixels decoded_pixels(std::string_view picture) {
  const PictureFormat format = format_of_picture(picture);
  if (format == PictureFormat::unknown) return with_fault(unknown_format);
  PicturePixels pixels = stated_size(format, picture);
  if (!pixels.fault.empty()) return pixels;

  const stbi_io_callbacks callbacks = PictureBytes::callbacks();
  const bool is_linear = format == PictureFormat::hdr;
  PictureBytes bytes(picture, is_linear);
  int width = 0;
  int height = 0;
  int channels = 0;
  if (is_linear) {
    pixels.linear.reset(stbi_loadf_from_callbacks(&callbacks, &bytes, &width, &height, &channels, 0));
  } else {
    pixels.codes.reset(stbi_load_from_callbacks(&callbacks, &bytes, &width, &height, &channels, 0));
  }
  const bool is_whole = (pixels.codes || pixels.linear) && !bytes.is_cut_off() && channels >= 1 && channels <= 4 &&
                        static_cast<std::size_t>(width) == pixels.width &&
                        static_cast<std::size_t>(height) == pixels.height;
  if (!is_whole) return with_fault(fault_of(format, bytes));
  pixels.channels = static_cast<std::size_t>(channels);
  pixels.has_alpha = channels % 2 == 0 && alpha_means_something(format, picture);
  return pixels;
}

}  // namespace patchlight
