#include "input/picture_colours.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/isolated.h"
#include "input/text.h"
#include "light/texture.h"

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

// The linear RGB of the pixels of a decoded picture. Of 16 bits the upper eight are taken.
class Pixels {
 public:
  explicit Pixels(const tinygltf::Image& image)
      : image_(image),
        value_bytes_(image.bits == 16 ? 2 : 1),
        channels_(static_cast<std::size_t>(image.component)),
        linear_(linear_values()) {}

  std::array<unsigned char, 3> codes(std::size_t pixel) const {
    std::array<unsigned char, 3> codes{};
    // Grey alone, or grey and alpha, stands for all three.
    for (std::size_t k = 0; k < 3; ++k)
      codes[k] = image_.image[(pixel * channels_ + (channels_ < 3 ? 0 : k)) * value_bytes_ + value_bytes_ - 1];
    return codes;
  }
  Rgb operator()(std::size_t pixel) const {
    const std::array<unsigned char, 3> of = codes(pixel);
    return {linear_[of[0]], linear_[of[1]], linear_[of[2]]};
  }

 private:
  const tinygltf::Image& image_;
  std::size_t value_bytes_;
  std::size_t channels_;
  std::array<double, 256> linear_;
};

Rgb of_texel(const std::array<float, 3>& texel) { return {texel[0], texel[1], texel[2]}; }

// Where a pixel goes when `from` of them become `to`: the texel in which it begins, and the share that lies in it.
std::pair<std::size_t, double> place_in(std::size_t pixel, std::size_t from, std::size_t to) {
  const std::size_t texel = pixel * to / from;
  // The texel ends at (texel + 1) from / to; whole numbers as long as they can be.
  const auto left = static_cast<double>((texel + 1) * from - pixel * to) / static_cast<double>(to);
  return {texel, std::min(1.0, left)};
}

// The means over equal parts of a picture, as few that there are at most `most`.
template <typename Colours>
Texture means_over_parts(const Colours& colours, std::size_t width, std::size_t height, std::size_t most) {
  std::size_t times = 1;
  const auto parts = [&times](std::size_t count) { return (count + times - 1) / times; };
  while (parts(width) * parts(height) > most) ++times;
  const std::size_t columns = parts(width);
  const std::size_t rows = parts(height);
  std::vector<Rgb> sums(columns * rows, Rgb{});
  const auto add = [&](std::size_t row, std::size_t column, const Rgb& colour, double weight) {
    if (weight <= 0) return;
    for (std::size_t k = 0; k < 3; ++k) sums[row * columns + column][k] += weight * colour[k];
  };
  for (std::size_t y = 0; y < height; ++y) {
    const auto [row, above] = place_in(y, height, rows);
    for (std::size_t x = 0; x < width; ++x) {
      const auto [column, left] = place_in(x, width, columns);
      const Rgb colour = colours(y * width + x);
      add(row, column, colour, above * left);
      add(row, column + 1, colour, above * (1 - left));
      add(row + 1, column, colour, (1 - above) * left);
      add(row + 1, column + 1, colour, (1 - above) * (1 - left));
    }
  }
  const double share = static_cast<double>(columns) * static_cast<double>(rows) /
                       (static_cast<double>(width) * static_cast<double>(height));
  Texture texture{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), {}};
  for (const Rgb& sum : sums)
    texture.texels.push_back(
        {static_cast<float>(share * sum[0]), static_cast<float>(share * sum[1]), static_cast<float>(share * sum[2])});
  return texture;
}

DecodedPicture picture_of(const tinygltf::Image& image, std::size_t most_texels) {
  const auto width = static_cast<std::size_t>(image.width);
  const auto height = static_cast<std::size_t>(image.height);
  const Pixels pixels(image);
  Spectrum sum = rgb(0, 0, 0);
  bool is_one_colour = true;
  for (std::size_t pixel = 0; pixel < width * height; ++pixel) {
    const Rgb colour = pixels(pixel);
    sum += rgb(colour[0], colour[1], colour[2]);
    is_one_colour = is_one_colour && pixels.codes(pixel) == pixels.codes(0);
  }
  if (is_one_colour) {
    const Rgb colour = pixels(0);
    return {rgb(colour[0], colour[1], colour[2]), nullptr, {}};
  }
  return {sum / static_cast<double>(width * height),
          std::make_shared<const Texture>(means_over_parts(pixels, width, height, most_texels)),
          {}};
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

// A few hundred bytes can stand for very many pixels, each of which takes up to eight bytes.
constexpr std::uint64_t most_pixels = std::uint64_t{8192} * 8192;

// Files that may be read and are there, with their bytes, and the faults of the others.
struct PictureFiles {
  std::vector<std::pair<std::string, std::string>> bytes;
  std::map<std::string, std::string> faults;
};

PictureFiles read_files(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine) {
  PictureFiles read;
  for (const std::filesystem::path& file : files) {
    try {
      require_within(confine, file, file.string());
      read.bytes.emplace_back(file.string(), read_text(file, file.string(), "the picture"));
    } catch (const InputError&) {
      read.faults.emplace(file.string(), "cannot be read; is there such a file?");
    }
  }
  return read;
}

}  // namespace

DecodedPicture decoded_picture(std::string_view picture, std::size_t most_texels) {
  const bool is_png = picture.starts_with("\x89PNG");
  if (!is_png && !picture.starts_with("\xFF\xD8\xFF")) return {{}, nullptr, "is neither PNG nor JPEG"};
  const std::uint64_t pixels = is_png ? pixels_of_png(picture) : pixels_of_jpeg(picture);
  if (pixels == 0) return {{}, nullptr, "is cut off"};
  if (pixels > most_pixels) return {{}, nullptr, "has more than 8192 x 8192 pixels"};
  std::string error;
  std::string warning;
  tinygltf::Image decoded;
  // The one member of tinygltf's LoadImageDataOption, which only its implementation declares: channels stay as they
  // are, three bytes a pixel rather than four.
  bool preserve_channels = true;
  const bool good = tinygltf::LoadImageData(&decoded, 0, &error, &warning, 0, 0,
                                            reinterpret_cast<const unsigned char*>(picture.data()),
                                            static_cast<int>(picture.size()), &preserve_channels) &&
                    decoded.width > 0 && decoded.height > 0 && decoded.component > 0 && !decoded.image.empty();
  if (!good) return {{}, nullptr, "cannot be decoded; is it whole?"};
  return picture_of(decoded, most_texels);
}

Texture reduced(const Texture& texture, std::size_t most_texels) {
  return means_over_parts([&](std::size_t k) { return of_texel(texture.texels[k]); }, texture.width, texture.height,
                          most_texels);
}

PictureColours picture_colours(const std::vector<std::filesystem::path>& files, const std::filesystem::path& confine,
                               const std::string& model) {
  PictureColours colours;
  PictureFiles read = read_files(files, confine);
  colours.faults = std::move(read.faults);
  const auto& pictures = read.bytes;
  if (pictures.empty()) return colours;
  // What a child process finds comes back as a scene: a material for each picture, and a note for each fault.
  const std::size_t most = std::min(most_texels_of_picture, most_texels_of_model / pictures.size());
  const auto decode = [&] {
    Scene scene;
    scene.notes.resize(pictures.size());
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      const DecodedPicture picture = decoded_picture(pictures[k].second, std::max(most, std::size_t{1}));
      scene.notes[k] = picture.fault;
      if (!picture.mean) continue;
      scene.materials.push_back({std::to_string(k), *picture.mean, rgb(0, 0, 0)});
      if (picture.texture)
        scene.materials.back().texture = {picture.texture, {rgb(1, 0, 0), rgb(0, 1, 0), rgb(0, 0, 1)}, {}};
    }
    return scene;
  };
  constexpr ChildLimits limits = {.seconds = 180, .bytes = std::uint64_t{4} << 30U};
  try {
    const Scene decoded = read_isolated(model, decode, limits);
    for (const Material& found : decoded.materials) {
      const auto& [file, bytes] = pictures[std::stoul(found.name)];
      colours.by_file.emplace(file, found.reflectance);
      if (found.texture) colours.textures.emplace(file, found.texture->texture);
      colours.digests.push_back(sha256({&bytes, 1}));
    }
    for (std::size_t k = 0; k < pictures.size(); ++k)
      if (!decoded.notes[k].empty()) colours.faults.emplace(pictures[k].first, decoded.notes[k]);
  } catch (const InputError& refused) {
    for (const auto& [file, bytes] : pictures) colours.faults.emplace(file, "cannot be decoded");
  }
  return colours;
}

}  // namespace patchlight
