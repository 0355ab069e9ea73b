#include "output/write_picture.h"

#include "patchlight/base/error.h"
#include "patchlight/output/write_image.h"

#include "base/shortest.h"
#include "light/photometry.h"
#include "output/write_exr.h"
#include "output/write_hdr.h"
#include "render/tone_map.h"

#include <algorithm>
#include <cmath>

namespace patchlight {
namespace {

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
