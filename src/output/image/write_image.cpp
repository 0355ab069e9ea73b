#include "patchlight/output/write_image.h"

#include "patchlight/base/error.h"

#include "output/file/write_bytes.h"
#include "output/image/png_bytes.h"
#include "render/tone_map.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <vtkAutoInit.h>
#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

// The one part of VTK used here that has to be registered before use.
VTK_MODULE_INIT(vtkRenderingFreeType)

namespace patchlight {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr int legend_numbers = 5;

Colour& pixel(DisplayImage& image, int x, int y) {
  return image
      .pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
}

DisplayImage black_image(int width, int height) {
  return {width, height, std::vector<Colour>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

// `below` with `above` laid over it, its upper left corner at (left, top); what sticks out is cut off.
DisplayImage laid_over(DisplayImage below, DisplayImage above, int left, int top) {
  for (int y = std::max(0, -top); y < std::min(above.height, below.height - top); ++y) {
    for (int x = std::max(0, -left); x < std::min(above.width, below.width - left); ++x) {
      pixel(below, left + x, top + y) = pixel(above, x, y);
    }
  }
  return below;
}

// White text on black, cut to its bounds. VTK draws it with FreeType and a font of its own: no display is needed.
DisplayImage text_image(const std::string& text, int font_size) {
  vtkNew<vtkTextProperty> style;
  style->SetFontFamilyToArial();
  style->SetFontSize(font_size);
  style->SetColor(1, 1, 1);
  vtkNew<vtkImageData> drawn;
  int size[2] = {0, 0};
  constexpr int dots_per_inch = 72;  // one point is one pixel
  vtkFreeTypeTools* const free_type = vtkFreeTypeTools::GetInstance();
  free_type->ScaleToPowerTwoOff();
  if (!free_type->RenderString(style, text, dots_per_inch, drawn, size)) return {};

  // VTK's rows go upward; four channels, the last is the coverage.
  DisplayImage image = black_image(size[0], size[1]);
  int extent[6];
  drawn->GetExtent(extent);
  for (int y = 0; y < size[1]; ++y) {
    for (int x = 0; x < size[0]; ++x) {
      const auto* const rgba =
          static_cast<const std::uint8_t*>(drawn->GetScalarPointer(extent[0] + x, extent[2] + size[1] - 1 - y, 0));
      pixel(image, x, y).fill(rgba[3]);
    }
  }
  return image;
}

std::string short_number(double value) {
  // Three digits; thousands are written out.
  const double size = std::abs(value);
  const bool is_whole = size >= 999.5 && size < 1e6;
  std::array<char, 32> text{};
  const auto [end, error] =
      std::to_chars(text.data(), text.data() + text.size(), value,
                    is_whole ? std::chars_format::fixed : std::chars_format::general, is_whole ? 0 : 3);
  return {text.data(), end};
}

// A column of false colours, the upper value at the top.
DisplayImage colour_bar(int width, int height) {
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(height, 1, 0);
  const std::vector<Colour> colours = false_color(values, 0, 1);
  DisplayImage bar = black_image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) pixel(bar, x, y) = colours[static_cast<std::size_t>(y)];
  }
  return bar;
}

}  // namespace

std::string png_bytes(const DisplayImage& image, const std::vector<PngText>& texts) {
  vtkNew<vtkImageData> data;
  data->SetDimensions(image.width, image.height, 1);
  data->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  // VTK's rows go upward.
  for (int y = 0; y < image.height; ++y) {
    const auto row = std::span(image.pixels)
                         .subspan(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width),
                                  static_cast<std::size_t>(image.width));
    auto* out = static_cast<std::uint8_t*>(data->GetScalarPointer(0, image.height - 1 - y, 0));
    for (const Colour& colour : row) out = std::copy(colour.begin(), colour.end(), out);
  }
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(data);
  writer->WriteToMemoryOn();
  for (const PngText& text : texts) writer->AddText(text.keyword.c_str(), text.text.c_str());
  writer->Write();
  vtkUnsignedCharArray* const encoded = writer->GetResult();
  if (writer->GetErrorCode() != 0 || encoded == nullptr) return {};
  return {reinterpret_cast<const char*>(encoded->GetPointer(0)),
          static_cast<std::size_t>(encoded->GetNumberOfValues())};
}

void write_png(const std::filesystem::path& file, const DisplayImage& image, const std::vector<PngText>& texts) {
  const std::string bytes = png_bytes(image, texts);
  if (bytes.empty()) throw OutputError(file.string(), "the picture cannot be encoded as PNG");
  write_bytes(file, bytes);
}

DisplayImage with_legend(const DisplayImage& image, double lower, double upper, const std::string& title) {
  const int font_size = std::max(9, image.height / 45);
  std::vector<DisplayImage> numbers;
  const DisplayImage heading = text_image(title, font_size);
  const int gap = font_size;
  int text_width = 0;
  for (int k = 0; k < legend_numbers; ++k) {
    const double part = static_cast<double>(k) / (legend_numbers - 1);
    numbers.push_back(text_image(short_number((1 - part) * upper + part * lower), font_size));
    text_width = std::max(text_width, numbers.back().width);
  }
  const int bar_width = 2 * font_size;
  const int width = 2 * gap + std::max(bar_width + gap / 2 + text_width, heading.width);
  const int bar_top = 3 * gap + heading.height / 2;
  const int bar_height = std::max(1, image.height - bar_top - 2 * gap);

  DisplayImage whole = laid_over(black_image(image.width + width, image.height), image, 0, 0);
  const int left = image.width + gap;
  whole = laid_over(std::move(whole), heading, left, gap);
  whole = laid_over(std::move(whole), colour_bar(bar_width, bar_height), left, bar_top);
  for (int k = 0; k < legend_numbers; ++k) {
    // Each number is centred at its height on the bar.
    const int middle = bar_top + k * (bar_height - 1) / (legend_numbers - 1);
    const DisplayImage& number = numbers[static_cast<std::size_t>(k)];
    whole = laid_over(std::move(whole), number, left + bar_width + gap / 2, middle - number.height / 2);
  }
  return whole;
}

}  // namespace patchlight
