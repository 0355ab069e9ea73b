#include "input/mitsuba/mitsuba_spectrum.h"

#include "patchlight/base/error.h"

#include "input/text.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace patchlight {
namespace {

constexpr double first_wavelength = 380;  // nm
constexpr double last_wavelength = 780;

double lobe(double wavelength, double peak, double below, double above) {
  const double t = (wavelength - peak) / (wavelength < peak ? below : above);
  return std::exp(-t * t / 2);
}

// Wyman, Sloan and Shirley 2013, "Simple analytic approximations to the CIE XYZ color matching functions", section 2.2.
Vector xyz_at(double wavelength) {
  return {1.056 * lobe(wavelength, 599.8, 37.9, 31.0) + 0.362 * lobe(wavelength, 442.0, 16.0, 26.7) -
              0.065 * lobe(wavelength, 501.1, 20.4, 26.2),
          0.821 * lobe(wavelength, 568.8, 46.9, 40.5) + 0.286 * lobe(wavelength, 530.9, 16.3, 31.1),
          1.217 * lobe(wavelength, 437.0, 11.8, 36.0) + 0.681 * lobe(wavelength, 459.0, 26.0, 13.8)};
}

// IEC 61966-2-1: from XYZ to linear RGB.
Vector rgb_weights(double wavelength) {
  Eigen::Matrix3d to_rgb;
  to_rgb << 3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570;
  return to_rgb * xyz_at(wavelength);
}

// The value of sampled wavelengths at one.
double sample_at(std::span<const std::pair<double, double>> samples, double wavelength) {
  const auto above = std::lower_bound(samples.begin(), samples.end(), wavelength,
                                      [](const auto& sample, double place) { return sample.first < place; });
  if (above == samples.end()) return 0;
  if (above->first == wavelength) return above->second;
  if (above == samples.begin()) return 0;
  const auto below = above - 1;
  const double share = (wavelength - below->first) / (above->first - below->first);
  return below->second + share * (above->second - below->second);
}

// Planck's law, W/(m^2 sr nm).
double planck(double wavelength, double kelvin) {
  constexpr double first = 1.191042972e-16;  // 2 h c^2, W m^2
  constexpr double second = 1.438776877e-2;  // h c / k, m K
  const double metres = wavelength * 1e-9;
  return 1e-9 * first / (std::pow(metres, 5) * std::expm1(second / (metres * kelvin)));
}

double linear_of_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

Spectrum linear_of_srgb(const Spectrum& values) {
  return values.unaryExpr([](double value) { return linear_of_srgb(value); });
}

[[noreturn]] void refuse(const MitsubaFile& file, const pugi::xml_node& node, const std::string& expected) {
  throw InputError(file.place(node), "<" + std::string(node.name()) + ">: found '" + file.text(node, "value") +
                                         "' where " + expected + " is expected");
}

// "#ff8000"
Spectrum of_hexadecimal(const MitsubaFile& file, const pugi::xml_node& node, const std::string& value) {
  if (value.size() != 7 || value.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    refuse(file, node, "a colour as #ff8000");
  const auto part = [&](std::size_t at) { return std::stoi(value.substr(at, 2), nullptr, 16) / 255.0; };
  return linear_of_srgb(rgb(part(1), part(3), part(5)));
}

// "400:0.1, 700:0.9"
Spectrum of_pairs(const MitsubaFile& file, const pugi::xml_node& node, std::string value) {
  std::replace(value.begin(), value.end(), ',', ' ');
  std::vector<std::pair<double, double>> samples;
  for (const std::string_view word : words(value)) {
    const std::size_t colon = word.find(':');
    const auto wavelength = finite_number(word.substr(0, colon));
    const auto sample = colon == std::string_view::npos ? std::nullopt : finite_number(word.substr(colon + 1));
    if (!wavelength || !sample || (!samples.empty() && *wavelength <= samples.back().first))
      refuse(file, node, "a spectrum as 400:0.1, 700:0.9, by growing wavelengths,");
    samples.emplace_back(*wavelength, *sample);
  }
  return rgb_of_wavelengths(samples);
}

MitsubaColour of_black_body(const MitsubaFile& file, const pugi::xml_node& node) {
  std::string stated = file.text(node, node.attribute("temperature") ? "temperature" : "value");
  if (!stated.empty() && (stated.back() == 'K' || stated.back() == 'k')) stated.pop_back();
  const auto kelvin = finite_number(trimmed(stated));
  if (!kelvin || !(*kelvin > 0)) throw InputError(file.place(node), "<blackbody>: expected a temperature above 0 K");
  const std::vector<double> scale = node.attribute("scale") ? file.numbers(node, "scale") : std::vector{1.0};
  std::vector<std::pair<double, double>> samples;
  for (double wavelength = first_wavelength; wavelength <= last_wavelength; wavelength += 5)
    samples.emplace_back(wavelength, (scale.empty() ? 1 : scale[0]) * planck(wavelength, *kelvin));
  return {rgb_of_wavelengths(samples).max(0), "a black body counts by its radiance per nm"};
}

// A colour of a checkerboard, which is no texture itself.
Spectrum field_colour(const MitsubaFile& file, const pugi::xml_node& node, const std::string& name, double otherwise) {
  const pugi::xml_node field = file.property(node, name);
  const bool is_texture = std::string_view(field.name()) == "texture";
  const auto colour = is_texture ? std::nullopt : mitsuba_colour(file, field);
  return colour ? colour->value : Spectrum::Constant(3, otherwise);
}

MitsubaColour of_texture(const MitsubaFile& file, const pugi::xml_node& node) {
  const std::string kind = file.text(node, "type");
  if (const std::optional<Spectrum> mean = kind == "bitmap" ? file.picture(node) : std::nullopt)
    return {*mean, "pictures count by their mean colour"};
  if (kind != "checkerboard") return {rgb(0.5, 0.5, 0.5), "textures that cannot be read count as 0.5"};
  return {(field_colour(file, node, "color0", 0.4) + field_colour(file, node, "color1", 0.2)) / 2,
          "checkerboards count by their mean"};
}

}  // namespace

Spectrum rgb_of_wavelengths(std::span<const std::pair<double, double>> samples) {
  Vector sum = Vector::Zero();
  Vector white = Vector::Zero();
  for (double wavelength = first_wavelength; wavelength <= last_wavelength; wavelength += 1) {
    const Vector weights = rgb_weights(wavelength);
    white += weights;
    sum += sample_at(samples, wavelength) * weights;
  }
  return rgb(sum.x() / white.x(), sum.y() / white.y(), sum.z() / white.z());
}

std::optional<MitsubaColour> mitsuba_colour(const MitsubaFile& file, const pugi::xml_node& node) {
  const std::string_view kind = node.name();
  if (kind == "texture") return of_texture(file, node);
  if (kind == "blackbody") return of_black_body(file, node);
  if (kind != "rgb" && kind != "srgb" && kind != "spectrum" && kind != "color" && kind != "float") return std::nullopt;
  const std::string value = file.text(node, "value");
  if (!value.empty() && value[0] == '#') return MitsubaColour{of_hexadecimal(file, node, value), ""};
  if (value.find(':') != std::string::npos)
    return MitsubaColour{of_pairs(file, node, value).max(0), "spectra count by their RGB"};
  const std::vector<double> numbers = file.numbers(node, "value");
  if (numbers.size() != 1 && numbers.size() != 3) refuse(file, node, "one number, or red, green and blue,");
  const Spectrum colour =
      numbers.size() == 3 ? rgb(numbers[0], numbers[1], numbers[2]) : Spectrum::Constant(3, numbers[0]);
  return MitsubaColour{kind == "srgb" ? linear_of_srgb(colour) : colour, ""};
}

}  // namespace patchlight
