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

/// A Mitsuba scene with the files that it includes, and the meaning of its values. Names of properties count without
/// capitals and underscores, so that "toWorld" of Mitsuba 0.5 and "to_world" of Mitsuba 3 are one: "toworld".
class MitsubaFile {
 public:
  /// Included files are looked for beside the one that names them, and must lie in the folder `confine` if there is
  /// one. \throws InputError naming file and line.
  MitsubaFile(const std::filesystem::path& file, const std::filesystem::path& confine);

  /// The children of <scene>, those of included files in the place of <include>.
  const std::vector<pugi::xml_node>& elements() const { return elements_; }

  /// The files, the scene itself first.
  const std::vector<std::unique_ptr<XmlFile>>& files() const { return files_; }

  /// "scene.xml:12", and the line in the scene itself: for what an included file holds, that of its <include>.
  std::string place(const pugi::xml_node& node) const;
  std::uint32_t line(const pugi::xml_node& node) const;

  /// The text of an attribute, with "$name" replaced by its <default>; empty if there is none.
  std::string text(const pugi::xml_node& node, const char* attribute) const;

  /// The property of this name, or the element that a <ref> of this name refers to; an empty node if there is none.
  /// \throws InputError where a <ref> names nothing.
  pugi::xml_node property(const pugi::xml_node& node, const std::string& name) const;

  /// Its value; `otherwise` if there is none.
  std::string word(const pugi::xml_node& node, const std::string& name, const std::string& otherwise) const;
  double number(const pugi::xml_node& node, const std::string& name, double otherwise) const;
  bool flag(const pugi::xml_node& node, const std::string& name) const;
  Vector vector(const pugi::xml_node& node, const std::string& name, const Vector& otherwise) const;

  /// The transformation "toworld"; none if it is not there.
  Eigen::Matrix4d to_world(const pugi::xml_node& node) const;

  /// The first nested element of a kind ("bsdf"), or the one that a <ref> there names; empty if there is none.
  pugi::xml_node nested(const pugi::xml_node& node, const std::string& kind) const;

  /// The mean color of the picture that a texture of the type bitmap names; nothing where it cannot be read.
  std::optional<Spectrum> picture(const pugi::xml_node& texture) const;
  const PictureColours& pictures() const { return pictures_; }

  /// The numbers of an attribute, separated by blanks and commas. \throws InputError where one is none.
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
  std::vector<std::uint32_t> lines_;  // per file: of its <include> in the first, 0 for that
  std::vector<std::filesystem::path> open_;
  std::vector<pugi::xml_node> elements_;
  std::map<std::string, std::string> defaults_;
  std::map<std::string, pugi::xml_node> by_id_;
  PictureColours pictures_;
};

/// A color as linear RGB, and what of it could not be carried.
struct MitsubaColour {
  Spectrum value;
  std::string simplified;  ///< for a note; empty if nothing is lost
};

/// The color of <rgb>, <srgb>, <spectrum>, <blackbody>, <float> or a texture; pictures and checkerboards count by their
/// mean, other textures as 0.5. Nothing for another element. \throws InputError naming the line.
std::optional<MitsubaColour> mitsuba_colour(const MitsubaFile& file, const pugi::xml_node& node);

/// The linear RGB (Rec. 709) of a spectrum that is piecewise linear between (wavelength in nm, value), 0 beyond, by the
/// color matching functions of the CIE 1931 observer as Wyman, Sloan and Shirley 2013 fit them. An even spectrum of 1
/// is 1, 1, 1.
Spectrum rgb_of_wavelengths(std::span<const std::pair<double, double>> samples);

}  // namespace patchlight
