#include "output/write_hdr.h"

#include "patchlight/output/provenance.h"

#include "base/shortest.h"
#include "output/write_bytes.h"
#include "render/tone_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

}  // namespace

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

}  // namespace patchlight
