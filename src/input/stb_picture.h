#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

namespace patchlight {

/// Memory that malloc() gave.
struct FreeMemory {
  void operator()(void* memory) const { std::free(memory); }
};

/// The pixels of a picture, row by row from the top, either as codes or as linear numbers.
struct PicturePixels {
  std::size_t width = 0;
  std::size_t height = 0;
  std::size_t channels = 0;                            ///< grey, grey and alpha, RGB, or RGB and alpha
  std::unique_ptr<unsigned char[], FreeMemory> codes;  ///< of sRGB; alpha is linear
  std::unique_ptr<float[], FreeMemory> linear;         ///< of Radiance's pictures, with Rec. 709 primaries
  bool has_alpha = false;                              ///< the last channel is one, and it means something
  std::string fault;  ///< why it could not be decoded, "is cut off"; then there is nothing else
};

/// Decodes PNG, JPEG, BMP and TGA of at most 8192 x 8192 pixels and Radiance HDR of at most 4096 x 8192. Of 16 bits the
/// upper eight are taken. Takes three to four bytes a pixel twice, of 16 bits and of HDR three times as much.
PicturePixels decoded_pixels(std::string_view picture);

}  // namespace patchlight
