#include "output/image/write_picture.h"

#include "patchlight/base/error.h"
#include "patchlight/output/provenance.h"
#include "patchlight/output/write_image.h"
#include "patchlight/views/picture.h"

#include "base/shortest.h"
#include "light/photometry.h"
#include "output/file/write_bytes.h"
#include "output/image/write_exr.h"
#include "render/tone_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

namespace patchlight {
namespace {

using SharedExponent = std::array<std::uint8_t, 4>;  // red, green, blue, exponent

// Scanlines of other widths are not run-length encoded.
constexpr int least_width = 8;
constexpr int most_width = 32767;

// Each mantissa m stands for (m + 1/2) 2^(e - 136): readers disagree on the half, which is below a mantissa's step.
SharedExponent shared_exponent(const std::array<double, 3>& rgb) {
  const double largest = std::max({rgb[0], rgb[1], rgb[2]});
  if (!(largest > 1e-32)) return {};
  int exponent = 0;
  const double scale = std::frexp(largest, &exponent) * 256 / largest;
  SharedExponent pixel{};
  for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::clamp(rgb[c] * scale, 0.0, 255.0));
  pixel[3] = static_cast<std::uint8_t>(exponent + 128);
  return pixel;
}

// One of the four components of a scanline: runs of equal bytes as 128 + length and the byte, others as their number
// and the bytes.
void append_runs(std::string& bytes, const std::vector<SharedExponent>& line, std::size_t component) {
  constexpr std::size_t least_run = 4;
  const auto run_at = [&](std::size_t begin) {
    std::size_t end = begin;
    while (end < line.size() && end - begin < 127 && line[end][component] == line[begin][component]) ++end;
    return end - begin;
  };
  for (std::size_t x = 0; x < line.size();) {
    const std::size_t run = run_at(x);
    if (run >= least_run) {
      bytes += static_cast<char>(128 + run);
      bytes += static_cast<char>(line[x][component]);
      x += run;
      continue;
    }
    std::size_t end = x;
    while (end < line.size() && end - x < 128 && run_at(end) < least_run) ++end;
    bytes += static_cast<char>(end - x);
    for (; x < end; ++x) bytes += static_cast<char>(line[x][component]);
  }
}

std::string numbers_of(const Vector& v) { return shortest(v.x()) + ' ' + shortest(v.y()) + ' ' + shortest(v.z()); }

// The horizontal size that goes with the vertical one for square pixels.
double horizontal(const Camera& camera, double aspect) {
  const double half = camera.vertical_field_of_view * std::numbers::pi / 360;
  const double degrees = 360 / std::numbers::pi;
  if (camera.projection == Projection::orthographic) return camera.height * aspect;
  if (camera.projection == Projection::perspective) return degrees * std::atan(aspect * std::tan(half));
  if (camera.projection == Projection::hemispherical)
    return degrees * std::asin(std::min(1.0, aspect * std::sin(half)));
  return camera.vertical_field_of_view * aspect;
}

std::string view_line(const Camera& camera, const Vector& up, const Image& image) {
  if (camera.projection == Projection::panorama) return "";
  const char type = camera.projection == Projection::orthographic    ? 'l'
                    : camera.projection == Projection::angular       ? 'a'
                    : camera.projection == Projection::hemispherical ? 'h'
                                                                     : 'v';
  const double aspect = static_cast<double>(image.width) / image.height;
  const double vertical = camera.projection == Projection::orthographic ? camera.height : camera.vertical_field_of_view;
  const Vector sight = (camera.target - camera.eye).normalized();
  const Vector upward = sight.cross(up).norm() > 1e-9 ? up : sight.cross(sight.unitOrthogonal());
  return std::string("VIEW= -vt") + type + " -vp " + numbers_of(camera.eye) + " -vd " + numbers_of(sight) + " -vu " +
         numbers_of(upward) + " -vh " + shortest(horizontal(camera, aspect)) + " -vv " + shortest(vertical) +
         " -vs 0 -vl 0\n";
}

// Writes the radiances of a picture as Radiance does, W/(m^2 sr) of linear RGB with Rec. 709 primaries: one exponent
// for three mantissas of eight bits (Ward 1991, Real Pixels), run-length encoded. The view goes with it, but for
// panoramas, which Radiance has none of. Throws OutputError.
void write_hdr(const std::filesystem::path& file, const Picture& picture, const Vector& up, const Bands& bands) {
  const Image& image = picture.radiance;
  std::string bytes = "#?RADIANCE\nSOFTWARE= patchlight " + std::string(version()) + '\n';
  bytes += view_line(picture.camera, up, image);
  if (picture.unfinished) bytes += "COMMENT= unfinished\n";
  bytes += "PRIMARIES= .64 .33 .3 .6 .15 .06 .3127 .329\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n";
  bytes += "-Y " + std::to_string(image.height) + " +X " + std::to_string(image.width) + '\n';
  const bool has_runs = image.width >= least_width && image.width <= most_width;
  std::vector<SharedExponent> line(static_cast<std::size_t>(image.width));
  for (Eigen::Index y = 0; y < image.height; ++y) {
    for (Eigen::Index x = 0; x < image.width; ++x)
      line[static_cast<std::size_t>(x)] = shared_exponent(linear_rgb(image.pixels.row(y * image.width + x), bands));
    if (!has_runs) {
      for (const SharedExponent& pixel : line) bytes.append(pixel.begin(), pixel.end());
      continue;
    }
    bytes += {2, 2, static_cast<char>(image.width >> 8), static_cast<char>(image.width & 255)};
    for (std::size_t component = 0; component < 4; ++component) append_runs(bytes, line, component);
  }
  write_bytes(file, bytes);
}

// The error map ends where all but one in twenty of the pixels lie below.
double end_of_errors(const Eigen::VectorXd& errors) {
  std::vector<double> sorted(errors.begin(), errors.end());
  if (sorted.empty()) return 1;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), end, sorted.end());
  return *end > 0 ? *end : 1;
}

}  // namespace

const std::vector<std::string>& picture_extensions() {
  static const std::vector<std::string> all = {".png", ".hdr", ".exr"};
  return all;
}

void write_picture(const std::filesystem::path& file, const Picture& picture, const Vector& up, const Bands& bands) {
  if (file.extension() == ".hdr") return write_hdr(file, picture, up, bands);
  if (file.extension() == ".exr") return write_exr(file, picture, bands);
  if (file.extension() != ".png")
    throw OutputError(file.string(), "expected a name of a picture that ends in .png, .hdr or .exr");
  std::vector<PngText> texts;
  if (picture.unfinished) texts.push_back({"Comment", "unfinished: stopped before its errors were as wanted"});
  if (picture.brightest)
    return write_png(file, with_legend(picture.image, 0, *picture.brightest, "luminance, cd/m^2"), texts);
  texts.push_back({"Exposure", shortest(picture.exposure) + " per W/(m^2 sr)"});
  write_png(file, picture.image, texts);
}

void write_difference(const std::filesystem::path& file, const Picture& first, const Picture& second,
                      const Bands& bands) {
  const Image& a = first.radiance;
  const Image& b = second.radiance;
  Eigen::VectorXd difference(a.pixels.rows());
  for (Eigen::Index k = 0; k < difference.size(); ++k)
    difference[k] = std::abs(luminance(a.pixels.row(k), bands) - luminance(b.pixels.row(k), bands));
  const double end = end_of_errors(difference);
  DisplayImage whole{3 * a.width, a.height, {}};
  const auto exposed = tone_map(b.pixels, first.exposure, bands);
  const auto colours = false_color(difference, 0, end);
  for (int y = 0; y < a.height; ++y) {
    for (const auto* part : {&first.image.pixels, &exposed, &colours}) {
      const auto row = part->begin() + static_cast<std::ptrdiff_t>(y) * a.width;
      whole.pixels.insert(whole.pixels.end(), row, row + a.width);
    }
  }
  write_png(file, with_legend(whole, 0, end, "difference, cd/m^2"));
}

void write_picture_errors(const std::filesystem::path& file, const Picture& picture) {
  const Image& image = picture.radiance;
  const double end = end_of_errors(image.error);
  const DisplayImage shown{image.width, image.height, false_color(image.error, 0, end)};
  write_png(file, with_legend(shown, 0, end, "standard error, cd/m^2"));
}

}  // namespace patchlight
