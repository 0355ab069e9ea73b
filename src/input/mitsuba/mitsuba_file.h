#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/spectrum.h"

#include "input/mitsuba/mitsuba_file.h"
#include "input/picture_colours.h"
#include "input/xml_file.h"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace patchlight {

/// A Mitsuba scene with its included files, and typed access to its values. Names of properties are compared without
/// capitals and underscores: "toWorld" of Mitsuba 0.5 and "to_world" of Mitsuba 3 are both "toworld".
class MitsubaFile {
 public:
  /// Included files are relative to the file that includes them, and must lie in the folder `confine`, if given.
  /// \throws InputError naming file and line.
  MitsubaFile(const std::filesystem::path& file, const std::filesystem::path& confine);

  /// The children of <scene>, with each <include> replaced by its contents.
  const std::vector<pugi::xml_node>& elements() const { return elements_; }

  /// The files, the scene itself first.
  const std::vector<std::unique_ptr<XmlFile>>& files() const { return files_; }

  /// "scene.xml:12". For elements of an included file it also gives the line of the <include>.
  std::string place(const pugi::xml_node& node) const;
  std::uint32_t line(const pugi::xml_node& node) const;

  /// The text of an attribute, with "$name" replaced by its <default>; empty if absent.
  std::string text(const pugi::xml_node& node, const char* attribute) const;

  /// The property of this name, or the target of a <ref> of this name; an empty node if absent. \throws InputError for
  /// a <ref> without a target.
  pugi::xml_node property(const pugi::xml_node& node, const std::string& name) const;

  /// Its value; `otherwise` if absent.
  std::string word(const pugi::xml_node& node, const std::string& name, const std::string& otherwise) const;
  double number(const pugi::xml_node& node, const std::string& name, double otherwise) const;
  bool flag(const pugi::xml_node& node, const std::string& name) const;
  Vector vector(const pugi::xml_node& node, const std::string& name, const Vector& otherwise) const;

  /// The transformation "toworld"; empty if absent.
  Eigen::Matrix4d to_world(const pugi::xml_node& node) const;

  /// The first nested element of a kind ("bsdf"), or the target of a <ref>; empty if absent.
  pugi::xml_node nested(const pugi::xml_node& node, const std::string& kind) const;

  /// The mean color of the picture of a bitmap texture; empty if it cannot be read.
  std::optional<Spectrum> picture(const pugi::xml_node& texture) const;
  const PictureColours& pictures() const { return pictures_; }

  /// The numbers of an attribute, separated by blanks and commas. \throws InputError for other words.
  std::vector<double> numbers(const pugi::xml_node& node, const char* attribute) const;

 private:
  void add(const std::filesystem::path& file, const std::filesystem::path& confine, const std::string& where,
           std::uint32_t line);
  const XmlFile& file_of(const pugi::xml_node& node) const;
  Vector axes(const pugi::xml_node& node, double otherwise) const;
  Eigen::Matrix4d step(const pugi::xml_node& node) const;
  std::filesystem::path picture_file(const pugi::xml_node& texture) const;
  double only_number(const pugi::xml_node& node, const char* attribute) const;

  std::vector<std::unique_ptr<XmlFile>> files_;
  std::vector<std::uint32_t> lines_;  // of each file: the line of its <include> in the scene, 0 for the scene
  std::vector<std::filesystem::path> open_;
  std::vector<pugi::xml_node> elements_;
  std::map<std::string, std::string> defaults_;
  std::map<std::string, pugi::xml_node> by_id_;
  PictureColours pictures_;
};

/// A color as linear RGB, and a note on its simplification.
struct MitsubaColour {
  Spectrum value;
  std::string simplified;  ///< for a note; empty if exact
};

/// The color of <rgb>, <srgb>, <spectrum>, <blackbody>, <float> or a texture. Pictures and checkerboards become their
/// mean; other textures become 0.5. Empty for other elements. \throws InputError naming the line.
std::optional<MitsubaColour> mitsuba_colour(const MitsubaFile& file, const pugi::xml_node& node);

/// The linear RGB (Rec. 709) of a spectrum, piecewise linear between pairs (wavelength in nm, value) and 0 beyond. Uses
/// the fit of the CIE 1931 color matching functions by Wyman, Sloan and Shirley 2013. A constant spectrum of 1 gives 1,
/// 1, 1.
Spectrum rgb_of_wavelengths(std::span<const std::pair<double, double>> samples);

}  // namespace patchlight
