#include "input/picture_colours.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/read_isolated.h"
#include "input/text.h"
#include "light/texture.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <stb/stb_image.h>
#include <utility>

namespace patchlight {
namespace {

enum class PictureFormat { png, jpeg, bmp, hdr, tga, unknown };

// A TGA has no signature: its second byte states whether it has a palette. JPEG 2000, AVIF and ICO also have a 0 there,
// but no valid image type in the third byte, so that stb_image refuses them.
PictureFormat format_of_picture(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return PictureFormat::png;
  if (bytes.starts_with("\xFF\xD8\xFF")) return PictureFormat::jpeg;
  if (bytes.starts_with("BM")) return PictureFormat::bmp;
  if (bytes.starts_with("#?RADIANCE\n") || bytes.starts_with("#?RGBE\n")) return PictureFormat::hdr;
  const bool may_be_tga = bytes.size() >= 18 && static_cast<unsigned char>(bytes[1]) <= 1;
  return may_be_tga ? PictureFormat::tga : PictureFormat::unknown;
}

// Bytes for stb_image, with a record of reads beyond the end. stb_image continues with zeros. In Radiance pictures
// these are runs of length 0 and loop forever, so that 0xFF is supplied instead.
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
  // stb_image reads ahead into one block, the first that it fills. All other reads request exactly the bytes needed.
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
  // stb_image takes an old-style run, (1, 1, 1, length), for a pixel and loses the pixels of the run.
  if (format == PictureFormat::hdr) return "has old-style runs, or is cut off";
  return format == PictureFormat::tga ? "is cut off, if it is a TGA" : "is cut off";
}

constexpr const char* too_large = "has more than 8192 x 8192 pixels";

// For sizes beyond its limits stb_image reports an unknown format. Its header readers report the cause.
bool is_beyond_limits(std::string_view picture) {
  const stbi_io_callbacks callbacks = PictureBytes::callbacks();
  PictureBytes bytes(picture, false);
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<unsigned char[], FreeMemory> codes(
      stbi_load_from_callbacks(&callbacks, &bytes, &width, &height, &channels, 0));
  return !codes && std::strcmp(stbi_failure_reason(), "too large") == 0;
}

// Width, height and channels of the header, checked first: a few hundred bytes can encode a huge picture. Has a fault
// where the header cannot be read or the picture is too large.
PicturePixels stated_size(PictureFormat format, std::string_view picture) {
  const stbi_io_callbacks callbacks = PictureBytes::callbacks();
  PictureBytes bytes(picture, false);
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_callbacks(&callbacks, &bytes, &width, &height, &channels)) {
    if (format == PictureFormat::tga) return with_fault(unknown_format);
    const bool may_be_large = format == PictureFormat::png || format == PictureFormat::jpeg;
    return with_fault(may_be_large && is_beyond_limits(picture) ? too_large : fault_of(format, bytes));
  }
  // A top-down BMP states a negative height.
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

// Some programs write a fourth byte that the header declares unused: a TGA by bits 0 to 3 of its last header byte, a
// BMP by the compression BI_RGB, 0, in the fourth word of the BITMAPINFOHEADER after the first 14 bytes.
bool alpha_means_something(PictureFormat format, std::string_view picture) {
  if (format == PictureFormat::tga) return (static_cast<unsigned char>(picture[17]) & 0xFU) != 0;
  return format != PictureFormat::bmp || picture.substr(30, 4) != std::string_view("\0\0\0\0", 4);
}

// Linear values of the 256 sRGB codes.
std::array<double, 256> linear_values() {
  std::array<double, 256> values{};
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = linear_of_srgb(static_cast<double>(k) / 255.0);
  return values;
}

// Linear RGB and alpha code of the pixels of a decoded picture.
class Pixels {
 public:
  explicit Pixels(const PicturePixels& picture) : picture_(picture), linear_(linear_values()) {}

  // Gray pictures have one channel, or two with alpha.
  Rgb operator()(std::size_t pixel) const {
    const std::size_t first = pixel * picture_.channels;
    const std::size_t step = picture_.channels < 3 ? 0 : 1;
    if (picture_.linear) {
      const float* const values = picture_.linear.get() + first;
      return {values[0], values[step], values[2 * step]};
    }
    const unsigned char* const codes = picture_.codes.get() + first;
    return {linear_[codes[0]], linear_[codes[step]], linear_[codes[2 * step]]};
  }
  // Mean of red, green and blue as stored in a picture of numbers, 0 to 1.
  double number(std::size_t pixel) const {
    const std::size_t first = pixel * picture_.channels;
    const std::size_t step = picture_.channels < 3 ? 0 : 1;
    if (picture_.linear) {
      const Rgb values = (*this)(pixel);
      return std::min(1.0, (values[0] + values[1] + values[2]) / 3);
    }
    const unsigned char* const codes = picture_.codes.get() + first;
    return (codes[0] + codes[step] + codes[2 * step]) / (3 * 255.0);
  }
  std::size_t alpha(std::size_t pixel) const {
    return picture_.has_alpha ? picture_.codes[(pixel + 1) * picture_.channels - 1] : std::size_t{255};
  }

 private:
  const PicturePixels& picture_;
  std::array<double, 256> linear_;
};

Rgb of_texel(const std::array<float, 3>& texel) { return {texel[0], texel[1], texel[2]}; }

// Reduces `from` pixels to `to` texels: the first texel that a pixel overlaps, and the fraction of the pixel in it.
std::pair<std::size_t, double> place_in(std::size_t pixel, std::size_t from, std::size_t to) {
  const std::size_t texel = pixel * to / from;
  // The texel ends at (texel + 1) from / to; integers as long as possible.
  const auto left = static_cast<double>((texel + 1) * from - pixel * to) / static_cast<double>(to);
  return {texel, std::min(1.0, left)};
}

// Means over equal parts of a picture, reduced by the smallest integer factor that leaves at most `most` texels.
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

Rgb sum_of(const Rgb& a, const Rgb& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

Rgb times(double factor, const Rgb& colour) { return {factor * colour[0], factor * colour[1], factor * colour[2]}; }

// Null for opaque pictures.
std::shared_ptr<const AlphaColours> alpha_colours(const Pixels& pixels, std::size_t count) {
  AlphaColours found;
  for (std::size_t pixel = 0; pixel < count; ++pixel) {
    const std::size_t alpha = pixels.alpha(pixel);
    found.count[alpha] += 1;
    found.sum[alpha] = sum_of(found.sum[alpha], pixels(pixel));
  }
  if (found.count.back() == count) return nullptr;
  return std::make_shared<const AlphaColours>(found);
}

DecodedPicture picture_of(const PicturePixels& decoded, std::size_t most_texels) {
  const std::size_t count = decoded.width * decoded.height;
  const Pixels pixels(decoded);
  DecodedPicture picture;
  const Rgb first = pixels(0);
  Rgb sum{};
  bool is_one_colour = true;
  for (std::size_t pixel = 0; pixel < count; ++pixel) {
    const Rgb colour = pixels(pixel);
    sum = sum_of(sum, colour);
    is_one_colour = is_one_colour && colour == first;
    picture.number += pixels.number(pixel);
  }
  picture.number /= static_cast<double>(count);
  if (decoded.has_alpha) picture.alpha = alpha_colours(pixels, count);
  const Rgb mean = is_one_colour ? first : times(1 / static_cast<double>(count), sum);
  picture.mean = rgb(mean[0], mean[1], mean[2]);
  if (!is_one_colour)
    picture.texture =
        std::make_shared<const Texture>(means_over_parts(pixels, decoded.width, decoded.height, most_texels));
  return picture;
}

// Readable files with their bytes, and the faults of the others.
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

// Number of texels kept of each picture.
std::size_t texels_of_one_of(std::size_t pictures) {
  return std::max(std::min(most_texels_of_picture, most_texels_of_model / pictures), std::size_t{1});
}

// Converts a mask to a row of numbers, and back.
Spectrum numbers_of_mask(const DecodedPicture& picture) {
  if (!picture.alpha) return Spectrum::Constant(1, picture.number);
  const Coverage coverage = coverage_by(*picture.alpha, [](double alpha) { return alpha; });
  Spectrum numbers(4);
  numbers << coverage.share, coverage.colour;
  return numbers;
}

PictureMask mask_from(const Spectrum& numbers) {
  if (numbers.size() == 1) return {numbers[0], std::nullopt};
  return {numbers[0], Spectrum(numbers.tail(3))};
}

// Least squares in the plane of the face: (u, v) = G q + c with q along two axes of the plane. Exact for triangles.
std::optional<TextureMap> map_of(std::span<const Point> corners, std::span<const Eigen::Vector2d> places) {
  const Vector normal = area_vector(corners);
  if (!(normal.norm() > 0)) return std::nullopt;
  Eigen::Matrix<double, 2, 3> axes;
  axes.row(0) = normal.normalized().unitOrthogonal().transpose();
  axes.row(1) = normal.normalized().cross(axes.row(0).transpose()).transpose();
  const auto count = static_cast<double>(corners.size());
  Point middle = Point::Zero();
  Eigen::Vector2d middle_place = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    middle += corners[k] / count;
    middle_place += places[k] / count;
  }
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d q = axes * (corners[k] - middle);
    squares += q * q.transpose();
    products += (places[k] - middle_place) * q.transpose();
  }
  if (!(std::abs(squares.determinant()) > 0)) return std::nullopt;
  TextureMap map;
  map.linear = products * squares.inverse() * axes;
  map.offset = middle_place - map.linear * middle;
  if (!map.linear.allFinite() || !map.offset.allFinite()) return std::nullopt;
  return map;
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
  int width = 0, height = 0, channels = 0;
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

// IEC 61966-2-1.
double linear_of_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

Coverage coverage_by(const AlphaColours& picture, const std::function<double(double)>& covered) {
  // Counting pixels and dividing once makes full coverage exactly 1, without rounding.
  double covering = 0;
  std::size_t all = 0;
  Rgb sum{};
  for (std::size_t alpha = 0; alpha < picture.count.size(); ++alpha) {
    const double share = covered(static_cast<double>(alpha) / 255);
    covering += share * static_cast<double>(picture.count[alpha]);
    all += picture.count[alpha];
    sum = sum_of(sum, times(share, picture.sum[alpha]));
  }
  Coverage coverage{covering / static_cast<double>(all), rgb(0, 0, 0)};
  if (covering > 0) coverage.colour = rgb(sum[0], sum[1], sum[2]) / covering;
  return coverage;
}

DecodedPicture decoded_picture(std::string_view picture, std::size_t most_texels) {
  const PicturePixels pixels = decoded_pixels(picture);
  if (pixels.fault.empty()) return picture_of(pixels, most_texels);
  DecodedPicture undecoded;
  undecoded.fault = pixels.fault;
  return undecoded;
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
  // The child process returns a scene: a material for each picture and a group for each fault.
  const std::size_t most = texels_of_one_of(pictures.size());
  const auto decode = [&] {
    Scene scene;
    scene.groups.resize(pictures.size());
    for (std::size_t k = 0; k < pictures.size(); ++k) {
      const DecodedPicture picture = decoded_picture(pictures[k].second, most);
      scene.groups[k] = picture.fault;
      if (!picture.mean) continue;
      scene.materials.push_back({std::to_string(k), *picture.mean, rgb(0, 0, 0)});
      scene.materials.back().transmittance = numbers_of_mask(picture);
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
      colours.masks.emplace(file, mask_from(found.transmittance));
      colours.digests.push_back(sha256({&bytes, 1}));
    }
    for (std::size_t k = 0; k < pictures.size(); ++k)
      if (!decoded.groups[k].empty()) colours.faults.emplace(pictures[k].first, decoded.groups[k]);
  } catch (const InputError& refused) {
    for (const auto& [file, bytes] : pictures) colours.faults.emplace(file, "cannot be decoded");
  }
  return colours;
}

std::array<Spectrum, 3> primaries_times(const Spectrum& factor) {
  return {rgb(factor[0], 0, 0), rgb(0, factor[1], 0), rgb(0, 0, factor[2])};
}

std::uint32_t MappedFaces::add(std::span<const Point> corners, std::span<const Eigen::Vector2d> places,
                               std::uint32_t line) {
  if (!(area_vector(corners).norm() > 0)) return no_texture_map;
  const bool known = places.size() == corners.size() && std::all_of(places.begin(), places.end(), [](const auto& at) {
                       return at.allFinite() && at.cwiseAbs().maxCoeff() <= 1e9;  // beyond that a texel is too small
                     });
  const std::optional<TextureMap> map = known ? map_of(corners, places) : std::nullopt;
  if (!map) {
    count(without_, line);
    return no_texture_map;
  }
  for (std::size_t k = 0; k < corners.size(); ++k) {
    if ((map->linear * corners[k] + map->offset - places[k]).norm() <= 1e-3)
      continue;  // six-digit numbers leave less
                 // texture points have six
                 // digits
    count(bent_, line);
    break;
  }
  maps_.push_back(*map);
  return static_cast<std::uint32_t>(maps_.size() - 1);
}

std::uint32_t MappedFaces::add(std::span<const Point> vertices, std::span<const std::uint32_t> corners,
                               std::uint32_t first, std::span<const Eigen::Vector2d> places) {
  std::vector<Point> points;
  std::vector<Eigen::Vector2d> in_picture;
  for (const std::uint32_t corner : corners) {
    points.push_back(vertices[corner]);
    if (corner - first < places.size()) in_picture.push_back(places[corner - first]);
  }
  return add(points, in_picture, 0);
}

void MappedFaces::count(Faces& faces, std::uint32_t line) {
  if (faces.count++ == 0) faces.first_line = line;
}

std::string MappedFaces::sentence(const Faces& faces, const std::string& what) const {
  const std::string first = faces.first_line > 0 ? " (first at " + at_line(file_, faces.first_line) + ")" : "";
  return what + ": " + std::to_string(faces.count) + first;
}

Diagnostics MappedFaces::notes() const {
  Diagnostics notes;
  if (without_.count > 0)
    notes.push_back(
        {DiagnosticCode::simplified_picture,
         sentence(without_, "faces without valid texture coordinates, which use the mean of their picture")});
  if (bent_.count > 0)
    notes.push_back({DiagnosticCode::simplified_picture,
                     sentence(bent_, "faces with a distorted picture, which is replaced by an undistorted one")});
  return notes;
}

}  // namespace patchlight
