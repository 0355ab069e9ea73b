#include "input/picture_colours.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/isolated.h"
#include "input/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tiny_gltf.h>
#include <utility>

namespace patchlight {
namespace {

// The 256 values of sRGB to linear, IEC 61966-2-1.
std::array<double, 256> linear_values() {
  std::array<double, 256> values{};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double srgb = static_cast<double>(k) / 255.0;
    values[k] = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
  }
  return values;
}

Spectrum mean_color(const tinygltf::Image& image) {
  const std::size_t bytes_per_value = image.bits == 16 ? 2 : 1;
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const auto channels = static_cast<std::size_t>(image.component);
  const std::array<double, 256> linear = linear_values();
  Spectrum sum = rgb(0, 0, 0);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    for (std::size_t k = 0; k < 3; ++k) {
      // Of 16 bits the upper eight are enough for a mean.
      const std::size_t value = (pixel * channels + std::min(k, channels - 1)) * bytes_per_value + bytes_per_value - 1;
      sum[static_cast<Eigen::Index>(k)] += linear[image.image[value]];
    }
  }
  return sum / static_cast<double>(pixels);
}

// A number of two or four bytes, most significant first.
std::uint64_t big_endian(std::string_view bytes) {
  std::uint64_t number = 0;
  for (const char byte : bytes) number = number << 8U | static_cast<unsigned char>(byte);
  return number;
}

// The pixels that a PNG says it has; 0 when it is cut off. PNG specification, section 11.2.2: after the signature, the
// length and the name of IHDR come width and height.
std::uint64_t pixels_of_png(std::string_view bytes) {
  if (bytes.size() < 24) return 0;
  return big_endian(bytes.substr(16, 4)) * big_endian(bytes.substr(20, 4));
}

// The same of a JPEG. ITU T.81, annex B: segments FF, marker, length; a frame header SOF has precision, height, width.
std::uint64_t pixels_of_jpeg(std::string_view bytes) {
  std::size_t at = 2;
  while (at + 9 <= bytes.size() && bytes[at] == '\xFF') {
    const auto marker = static_cast<unsigned char>(bytes[at + 1]);
    const bool is_table = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
    if (marker >= 0xC0 && marker <= 0xCF && !is_table) {
      return big_endian(bytes.substr(at + 5, 2)) * big_endian(bytes.substr(at + 7, 2));
    }
    at += marker == 0xFF ? 1 : 2 + big_endian(bytes.substr(at + 2, 2));
  }
  return 0;
}

// A few hundred bytes can stand for very many pixels, each of which takes eight bytes.
constexpr std::uint64_t most_pixels = std::uint64_t{8192} * 8192;

// The bytes of those files that may be read and are there.
std::vector<std::pair<std::string, std::string>> picture_bytes(const std::vector<std::filesystem::path>& files,
                                                               const std::filesystem::path& confine) {
  std::vector<std::pair<std::string, std::string>> pictures;
  for (const std::filesystem::path& file : files) {
    try {
      require_within(confine, file, file.string());
      pictures.emplace_back(file.string(), read_text(file, file.string(), "the picture"));
    } catch (const InputError&) {
      continue;
    }
  }
  return pictures;
}

}  // namespace

std::optional<Spectrum> mean_colour(std::string_view picture) {
  const bool is_png = picture.starts_with("\x89PNG");
  if (!is_png && !picture.starts_with("\xFF\xD8\xFF")) return std::nullopt;
  const std::uint64_t pixels = is_png ? pixels_of_png(picture) : pixels_of_jpeg(picture);
  if (pixels == 0 || pixels > most_pixels) return std::nullopt;
  std::string error;
  std::string warning;
  tinygltf::Image decoded;
  const bool good = tinygltf::LoadImageData(&decoded, 0, &error, &warning, 0, 0,
                                            reinterpret_cast<const unsigned char*>(picture.data()),
                                            static_cast<int>(picture.size()), nullptr) &&
                    decoded.width > 0 && decoded.height > 0 && decoded.component > 0 && !decoded.image.empty();
  return good ? std::optional(mean_color(decoded)) : std::nullopt;
}

PictureColours picture_colours(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine,
                               const std::string& model) {
  PictureColours colours;
  const auto pictures = picture_bytes(files, confine);
  if (pictures.empty()) return colours;
  // What a child process finds comes back as a scene: a material for each picture that could be decoded.
  const auto decode = [&] {
    Scene scene;
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      const std::optional<Spectrum> mean = mean_colour(pictures[k].second);
      if (mean) scene.materials.push_back({std::to_string(k), *mean, rgb(0, 0, 0)});
    }
    return scene;
  };
  constexpr ChildLimits limits = {.seconds = 180, .bytes = std::uint64_t{4} << 30U};
  try {
    for (const Material& found : read_isolated(model, decode, limits).materials) {
      const auto& [file, bytes] = pictures[std::stoul(found.name)];
      colours.by_file.emplace(file, found.reflectance);
      colours.digests.push_back(sha256({&bytes, 1}));
    }
  } catch (const InputError&) {
    return {};
  }
  return colours;
}

}  // namespace patchlight
