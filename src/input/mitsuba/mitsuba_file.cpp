#include "input/mitsuba/mitsuba_file.h"

#include "patchlight/base/error.h"

#include "input/round_shapes.h"
#include "input/text.h"
#include "light/spectra.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <system_error>

namespace patchlight {
namespace {

// Adds the nodes that have an id, and do not refer to another by it.
class Identified : public pugi::xml_tree_walker {
 public:
  explicit Identified(std::map<std::string, pugi::xml_node>& by_id) : by_id_(by_id) {}

  bool for_each(pugi::xml_node& node) override {
    if (node.attribute("id") && std::string_view(node.name()) != "ref")
      by_id_.emplace(node.attribute("id").value(), node);
    return true;
  }

 private:
  std::map<std::string, pugi::xml_node>& by_id_;
};

// "toWorld" and "to_world" as "toworld".
std::string plain_name(const char* name) {
  std::string result;
  for (; *name != 0; ++name) {
    if (*name >= 'A' && *name <= 'Z') {
      result += static_cast<char>(*name - 'A' + 'a');
    } else if (*name != '_') {
      result += *name;
    }
  }
  return result;
}

// The transformation from a frame that looks along +z, with y up and x to the left, to the world.
std::optional<Eigen::Matrix4d> look_at(const Vector& origin, const Vector& target, const Vector& up) {
  const Vector forward = (target - origin).stableNormalized();
  const Vector left = up.cross(forward).stableNormalized();
  if (!(forward.norm() > 0.5) || !(left.norm() > 0.5)) return std::nullopt;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() << left, forward.cross(left), forward;
  matrix.topRightCorner<3, 1>() = origin;
  return matrix;
}

Eigen::Matrix4d with_linear(const Eigen::Matrix3d& linear) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = linear;
  return matrix;
}

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

// Interpolates sampled wavelengths.
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

Spectrum linear_rgb_of(const Spectrum& values) {
  return values.unaryExpr([](double value) { return linear_of_srgb(value); });
}

[[noreturn]] void refuse(const MitsubaFile& file, const pugi::xml_node& node, const std::string& expected) {
  throw InputError(file.place(node), "<" + std::string(node.name()) + ">: found '" + file.text(node, "value") +
                                         "' where " + expected + " is expected");
}

// "#ff8000"
Spectrum of_hexadecimal(const MitsubaFile& file, const pugi::xml_node& node, const std::string& value) {
  if (value.size() != 7 || value.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    refuse(file, node, "a color, e.g. #ff8000");
  const auto part = [&](std::size_t at) { return std::stoi(value.substr(at, 2), nullptr, 16) / 255.0; };
  return linear_rgb_of(rgb(part(1), part(3), part(5)));
}

// Reads "400:0.1, 700:0.9".
Spectrum of_pairs(const MitsubaFile& file, const pugi::xml_node& node, std::string value) {
  std::replace(value.begin(), value.end(), ',', ' ');
  std::vector<std::pair<double, double>> samples;
  for (const std::string_view word : words(value)) {
    const std::size_t colon = word.find(':');
    const auto wavelength = finite_number(word.substr(0, colon));
    const auto sample = colon == std::string_view::npos ? std::nullopt : finite_number(word.substr(colon + 1));
    if (!wavelength || !sample || (!samples.empty() && *wavelength <= samples.back().first))
      refuse(file, node, "a spectrum with increasing wavelengths, e.g. 400:0.1, 700:0.9,");
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
  for (double wavelength = shortest_wavelength; wavelength <= longest_wavelength; wavelength += 5)
    samples.emplace_back(wavelength, (scale.empty() ? 1 : scale[0]) * planck(wavelength, *kelvin));
  return {rgb_of_wavelengths(samples).max(0), "a black body uses its radiance per nm"};
}

// A checkerboard color; nested textures are not allowed.
Spectrum field_colour(const MitsubaFile& file, const pugi::xml_node& node, const std::string& name, double otherwise) {
  const pugi::xml_node field = file.property(node, name);
  const bool is_texture = std::string_view(field.name()) == "texture";
  const auto colour = is_texture ? std::nullopt : mitsuba_colour(file, field);
  return colour ? colour->value : Spectrum::Constant(3, otherwise);
}

MitsubaColour of_texture(const MitsubaFile& file, const pugi::xml_node& node) {
  const std::string kind = file.text(node, "type");
  if (const std::optional<Spectrum> mean = kind == "bitmap" ? file.picture(node) : std::nullopt)
    return {*mean, "pictures are replaced by their mean color"};
  if (kind != "checkerboard") return {rgb(0.5, 0.5, 0.5), "unreadable textures are replaced by 0.5"};
  return {(field_colour(file, node, "color0", 0.4) + field_colour(file, node, "color1", 0.2)) / 2,
          "checkerboards are replaced by their mean"};
}

}  // namespace

MitsubaFile::MitsubaFile(const std::filesystem::path& file, const std::filesystem::path& confine) {
  add(file, confine, file.string(), 0);
  struct Textures : pugi::xml_tree_walker {
    std::vector<pugi::xml_node> found;
    bool for_each(pugi::xml_node& node) override {
      if (std::string_view(node.name()) == "texture") found.push_back(node);
      return true;
    }
  } textures;
  for (const std::unique_ptr<XmlFile>& xml : files_) xml->document.traverse(textures);
  std::set<std::filesystem::path> pictures;
  for (const pugi::xml_node& texture : textures.found) {
    if (text(texture, "type") == "bitmap") pictures.insert(picture_file(texture));
  }
  pictures_ = picture_colours({pictures.begin(), pictures.end()}, confine, file.string());
}

std::filesystem::path MitsubaFile::picture_file(const pugi::xml_node& texture) const {
  return std::filesystem::path(files_[0]->file).parent_path() / word(texture, "filename", "");
}

std::optional<Spectrum> MitsubaFile::picture(const pugi::xml_node& texture) const {
  const auto found = pictures_.by_file.find(picture_file(texture).string());
  return found == pictures_.by_file.end() ? std::nullopt : std::optional(found->second);
}

void MitsubaFile::add(const std::filesystem::path& file, const std::filesystem::path& confine, const std::string& where,
                      std::uint32_t line) {
  require_within(confine, file, where);
  std::error_code error;
  open_.push_back(std::filesystem::weakly_canonical(file, error));
  if (std::find(open_.begin(), open_.end() - 1, open_.back()) != open_.end() - 1 || files_.size() == 1000 ||
      open_.size() > reading_limits::nesting)
    throw InputError(where, "includes " + file.string() +
                                ", which includes this file again, or more than 1,000 files, or is more than 64 deep");
  files_.push_back(std::make_unique<XmlFile>(read_xml_file(file, where)));
  lines_.push_back(line);
  const XmlFile& xml = *files_.back();
  const pugi::xml_node root = xml.document.child("scene");
  if (!root) throw InputError(where, "has no <scene>; expected a Mitsuba scene, <scene version=\"3.0.0\">");

  Identified ids(by_id_);
  files_.back()->document.traverse(ids);
  for (const pugi::xml_node& node : root.children()) {
    const std::string_view kind = node.name();
    if (kind == "default") {
      const std::string value = node.attribute("value").value();
      if (value.size() > reading_limits::variable_length)
        throw InputError(place_of(xml, node), "<default> has a value of more than 4,096 characters; expected fewer");
      defaults_.emplace(node.attribute("name").value(), value);
    } else if (kind == "include") {
      add(file.parent_path() / text(node, "filename"), confine, place_of(xml, node),
          line == 0 ? line_of(xml, node) : line);
    } else if (node.type() == pugi::node_element) {
      elements_.push_back(node);
    }
  }
  open_.pop_back();
}

const XmlFile& MitsubaFile::file_of(const pugi::xml_node& node) const {
  const pugi::xml_node root = node.root();
  return **std::find_if(files_.begin(), files_.end() - 1, [&](const auto& file) { return file->document == root; });
}

std::string MitsubaFile::place(const pugi::xml_node& node) const { return place_of(file_of(node), node); }

std::uint32_t MitsubaFile::line(const pugi::xml_node& node) const {
  const XmlFile& file = file_of(node);
  for (std::size_t k = 1; k < files_.size(); ++k) {
    if (files_[k].get() == &file) return lines_[k];
  }
  return line_of(file, node);
}

// The longest known name matches: $spp2 is not $spp followed by 2.
std::string MitsubaFile::text(const pugi::xml_node& node, const char* attribute) const {
  const std::string_view said = node.attribute(attribute).value();
  std::string result;
  for (std::size_t at = 0; at < said.size(); ++at) {
    if (said[at] != '$') {
      result += said[at];
      continue;
    }
    const std::pair<const std::string, std::string>* best = nullptr;
    for (const auto& known : defaults_) {
      const bool is_it = !known.first.empty() && said.substr(at + 1, known.first.size()) == known.first;
      if (is_it && (best == nullptr || known.first.size() > best->first.size())) best = &known;
    }
    if (best == nullptr)
      throw InputError(
          place(node),
          "'" + std::string(said) +
              "' names a variable without a <default> before it\nhint: add one, e.g. <default name=\"size\" "
              "value=\"1\"/>");
    result += best->second;
    at += best->first.size();
    if (result.size() > reading_limits::text_length)
      throw InputError(place(node), std::string(attribute) +
                                        " has more than a million characters, with the values of its "
                                        "variables; expected fewer");
  }
  return result;
}

pugi::xml_node MitsubaFile::property(const pugi::xml_node& node, const std::string& name) const {
  const pugi::xml_node found =
      node.find_child([&](const pugi::xml_node& child) { return plain_name(child.attribute("name").value()) == name; });
  if (std::string_view(found.name()) != "ref") return found;
  const auto meant = by_id_.find(text(found, "id"));
  if (meant == by_id_.end())
    throw InputError(place(found), "<ref> names '" + text(found, "id") + "', which nothing has as its id");
  return meant->second;
}

std::string MitsubaFile::word(const pugi::xml_node& node, const std::string& name, const std::string& otherwise) const {
  const pugi::xml_node found = property(node, name);
  return found ? text(found, "value") : otherwise;
}

std::vector<double> MitsubaFile::numbers(const pugi::xml_node& node, const char* attribute) const {
  std::string values = text(node, attribute);
  std::replace_if(
      values.begin(), values.end(), [](char c) { return c == ',' || c == '\n' || c == '\r'; }, ' ');
  std::vector<double> found;
  for (const std::string_view word : words(values)) {
    const std::optional<double> number = finite_number(word);
    if (!number)
      throw InputError(place(node), "<" + std::string(node.name()) + ">: found '" + std::string(word) + "' where " +
                                        attribute + " has a number");
    found.push_back(*number);
  }
  return found;
}

double MitsubaFile::only_number(const pugi::xml_node& node, const char* attribute) const {
  const std::vector<double> found = numbers(node, attribute);
  if (found.size() == 1) return found[0];
  throw InputError(place(node), "<" + std::string(node.name()) + ">: found '" + text(node, attribute) +
                                    "' where one number is expected");
}

double MitsubaFile::number(const pugi::xml_node& node, const std::string& name, double otherwise) const {
  const pugi::xml_node found = property(node, name);
  return found ? only_number(found, "value") : otherwise;
}

bool MitsubaFile::flag(const pugi::xml_node& node, const std::string& name) const {
  return word(node, name, "false") == "true";
}

// Reads value="1, 2, 3", value="2" for all axes, or x, y and z separately.
Vector MitsubaFile::axes(const pugi::xml_node& node, double otherwise) const {
  Vector result = Vector::Constant(otherwise);
  if (node.attribute("value")) {
    const std::vector<double> found = numbers(node, "value");
    if (found.size() == 1) return Vector::Constant(found[0]);
    if (found.size() != 3)
      throw InputError(place(node), "<" + std::string(node.name()) + ">: expected one or three numbers, found '" +
                                        text(node, "value") + "'");
    return {found[0], found[1], found[2]};
  }
  constexpr const char* names[] = {"x", "y", "z"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (node.attribute(names[k])) result[k] = only_number(node, names[k]);
  }
  return result;
}

Vector MitsubaFile::vector(const pugi::xml_node& node, const std::string& name, const Vector& otherwise) const {
  const pugi::xml_node found = property(node, name);
  return found ? axes(found, 0) : otherwise;
}

Eigen::Matrix4d MitsubaFile::step(const pugi::xml_node& node) const {
  const std::string kind = plain_name(node.name());
  if (kind == "translate") {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topRightCorner<3, 1>() = axes(node, 0);
    return matrix;
  }
  if (kind == "scale") return with_linear(axes(node, 1).asDiagonal());
  if (kind == "rotate") {
    const Vector axis = axes(node, 0);
    if (!(axis.stableNorm() > 0)) throw InputError(place(node), "<rotate> has the axis 0, 0, 0; expected a direction");
    return with_linear(turned_about(axis.stableNormalized(), only_number(node, "angle")));
  }
  if (kind == "matrix") {
    const std::vector<double> m = numbers(node, "value");
    if (m.size() == 9) return with_linear(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.data()));
    if (m.size() == 16) return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data());
    throw InputError(place(node), "<matrix> has " + std::to_string(m.size()) + " numbers; expected 9 or 16");
  }
  if (kind == "lookat") {
    const auto point = [&](const char* name, const std::vector<double>& otherwise) {
      const std::vector<double> found = node.attribute(name) ? numbers(node, name) : otherwise;
      if (found.size() != 3) throw InputError(place(node), std::string("<lookat>: expected three numbers in ") + name);
      return Vector(found[0], found[1], found[2]);
    };
    const auto matrix = look_at(point("origin", {0, 0, 0}), point("target", {0, 0, 1}), point("up", {0, 1, 0}));
    if (matrix) return *matrix;
    throw InputError(place(node),
                     "<lookat> looks nowhere, or along its up; expected two places and a direction across");
  }
  throw InputError(place(node), "the transformation <" + std::string(node.name()) +
                                    "> is not known; expected translate, scale, rotate, matrix or lookat");
}

Eigen::Matrix4d MitsubaFile::to_world(const pugi::xml_node& node) const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (const pugi::xml_node& child : property(node, "toworld").children()) {
    if (child.type() == pugi::node_element) matrix = step(child) * matrix;
  }
  return matrix;
}

pugi::xml_node MitsubaFile::nested(const pugi::xml_node& node, const std::string& kind) const {
  for (const pugi::xml_node& child : node.children()) {
    if (child.name() == kind) return child;
    if (std::string_view(child.name()) != "ref") continue;
    const auto found = by_id_.find(text(child, "id"));
    if (found != by_id_.end() && found->second.name() == kind) return found->second;
  }
  return {};
}

Spectrum rgb_of_wavelengths(std::span<const std::pair<double, double>> samples) {
  Vector sum = Vector::Zero();
  Vector white = Vector::Zero();
  for (double wavelength = shortest_wavelength; wavelength <= longest_wavelength; wavelength += 1) {
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
    return MitsubaColour{of_pairs(file, node, value).max(0), "spectra are replaced by their RGB"};
  const std::vector<double> numbers = file.numbers(node, "value");
  if (numbers.size() != 1 && numbers.size() != 3) refuse(file, node, "one number, or red, green and blue,");
  const Spectrum colour =
      numbers.size() == 3 ? rgb(numbers[0], numbers[1], numbers[2]) : Spectrum::Constant(3, numbers[0]);
  return MitsubaColour{kind == "srgb" ? linear_rgb_of(colour) : colour, ""};
}

}  // namespace patchlight
