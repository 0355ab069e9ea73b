// The one part of VTK used here that has to be registered before use.
#include "output/image/write_image.h"

#include "patchlight/base/error.h"

#include "base/tolerances.h"
#include "base/words.h"
#include "light/photometry.h"
#include "output/file/whole_file.h"
#include "render/tone_map.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <exception>
#include <numbers>
#include <utility>
#include <vtkAutoInit.h>
#include <vtkFreeTypeTools.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedCharArray.h>

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

// `below` with `above` laid over it, its upper left corner at (left, top), and cut off at the edges.
DisplayImage laid_over(DisplayImage below, DisplayImage above, int left, int top) {
  for (int y = std::max(0, -top); y < std::min(above.height, below.height - top); ++y) {
    for (int x = std::max(0, -left); x < std::min(above.width, below.width - left); ++x)
      pixel(below, left + x, top + y) = pixel(above, x, y);
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
  vtkFreeTypeTools* const free_type = vtkFreeTypeTools::GetInstance();
  free_type->ScaleToPowerTwoOff();
  // At 72 dots per inch one point is one pixel.
  if (!free_type->RenderString(style, text, 72, drawn, size)) return {};

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

// A column of false colors, the upper value at the top.
DisplayImage colour_bar(int width, int height) {
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(height, 1, 0);
  const std::vector<Colour> colours = false_color(values, 0, 1);
  DisplayImage bar = black_image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) pixel(bar, x, y) = colours[static_cast<std::size_t>(y)];
  }
  return bar;
}

std::vector<ExrChannel> channels_of(const Picture& picture, const Bands& bands) {
  const Image& image = picture.radiance;
  const auto count = static_cast<std::size_t>(image.pixels.rows());
  std::vector<ExrChannel> all;
  for (const char* name : {"R", "G", "B", "luminance.Y"}) all.push_back({name, std::vector<float>(count)});
  for (std::size_t k = 0; k < count; ++k) {
    const Spectrum radiance = image.pixels.row(static_cast<Eigen::Index>(k));
    const std::array<double, 3> rgb = linear_rgb(radiance, bands);
    for (std::size_t c = 0; c < 3; ++c) all[c].values[k] = static_cast<float>(rgb[c]);
    all[3].values[k] = static_cast<float>(luminance(radiance, bands));
  }
  const auto add = [&](const char* name, const auto& values) {
    if (values.size() == 0) return;
    ExrChannel channel{name, std::vector<float>(count)};
    for (std::size_t k = 0; k < count; ++k)
      channel.values[k] = static_cast<float>(values[static_cast<Eigen::Index>(k)]);
    all.push_back(std::move(channel));
  };
  add("error.Y", image.error);
  add("depth.Z", image.depth);
  if (image.normal.size() > 0) {
    add("normal.X", Eigen::VectorXd(image.normal.col(0)));
    add("normal.Y", Eigen::VectorXd(image.normal.col(1)));
    add("normal.Z", Eigen::VectorXd(image.normal.col(2)));
  }
  return all;
}

// Besides numbers, one channel of whole ones if there are any.
void write_channels(const std::filesystem::path& file, Imf::Header header, const std::vector<ExrChannel>& channels,
                    std::vector<std::uint32_t> patches) {
  header.compression() = Imf::ZIP_COMPRESSION;
  header.insert("software", Imf::StringAttribute(std::string("patchlight ") + version()));
  const auto width = static_cast<std::size_t>(header.dataWindow().max.x + 1);
  Imf::FrameBuffer pixels;
  const auto add = [&](const std::string& name, Imf::PixelType type, const void* values) {
    header.channels().insert(name, Imf::Channel(type));
    // OpenEXR only reads the values.
    pixels.insert(name, Imf::Slice(type, static_cast<char*>(const_cast<void*>(values)), 4, 4 * width));
  };
  for (const ExrChannel& channel : channels) add(channel.name, Imf::FLOAT, channel.values.data());
  if (!patches.empty()) add("patch.id", Imf::UINT, patches.data());
  write_whole_file(file, [&](const std::filesystem::path& temporary) {
    Imf::OutputFile out(temporary.c_str(), header, 1);
    out.setFrameBuffer(pixels);
    out.writePixels(header.dataWindow().max.y + 1);
  });
}

// Errors of OpenEXR as OutputError.
template <class Write>
void in_our_words(const std::filesystem::path& file, const Write& write) {
  try {
    write();
  } catch (const OutputError&) {
    throw;
  } catch (const std::exception& error) {
    throw OutputError(file.string(), std::string("the picture cannot be written as OpenEXR: ") + error.what());
  }
}

using SharedExponent = std::array<std::uint8_t, 4>;  // red, green, blue, exponent

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

// One of the four components of a scanline. A run of equal bytes becomes 128 + length and the byte; other bytes follow
// their number.
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
  const Vector upward = sight.cross(up).norm() > tolerance_of_shapes ? up : sight.cross(sight.unitOrthogonal());
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
  bytes += "PRIMARIES= 0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n";
  bytes += "-Y " + std::to_string(image.height) + " +X " + std::to_string(image.width) + '\n';
  // Scanlines of other widths are not run-length encoded.
  const bool has_runs = image.width >= 8 && image.width <= 32767;
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
  const double end = errors.size() == 0 ? 0 : quantile({errors.begin(), errors.end()}, 0.95);
  return end > 0 ? end : 1;
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
    // Each number is centered at its height on the bar.
    const int middle = bar_top + k * (bar_height - 1) / (legend_numbers - 1);
    const DisplayImage& number = numbers[static_cast<std::size_t>(k)];
    whole = laid_over(std::move(whole), number, left + bar_width + gap / 2, middle - number.height / 2);
  }
  return whole;
}

void write_exr(const std::filesystem::path& file, int width, int height, const std::vector<ExrChannel>& channels,
               const std::string& comment) {
  in_our_words(file, [&] {
    Imf::Header header(width, height);
    if (!comment.empty()) header.insert("comments", Imf::StringAttribute(comment));
    write_channels(file, std::move(header), channels, {});
  });
}

void write_exr(const std::filesystem::path& file, const Picture& picture, const Bands& bands) {
  const Image& image = picture.radiance;
  in_our_words(file, [&] {
    Imf::Header header(image.width, image.height);
    if (picture.unfinished) header.insert("comments", Imf::StringAttribute("unfinished"));
    write_channels(file, std::move(header), channels_of(picture, bands), {image.patch.begin(), image.patch.end()});
  });
}

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

void write_observers(const std::filesystem::path& file, std::span<const ObserverReading> observers) {
  std::string text = "observer,E_vertical_lx,E_cylindrical_lx,L_background_cd_m2,glare_sr,UGR\n";
  for (const ObserverReading& one : observers) {
    text += csv_cell(one.name) + ',' + csv_cell(one.vertical_illuminance) + ',' +
            csv_cell(one.cylindrical_illuminance) + ',' + csv_cell(one.background_luminance) + ',' +
            csv_cell(one.glare_solid_angle) + ',' + csv_cell(one.unified_glare_rating.value_or(std::nan(""))) + '\n';
  }
  write_bytes(file, text);
}

}  // namespace patchlight
