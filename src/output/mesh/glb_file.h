#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/output/write_result.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

namespace patchlight {

/// A binary glTF 2.0 with one buffer and one mesh, built step by step.
class GlbFile {
 public:
  /// The node of the mesh stands at this translation.
  GlbFile(const Provenance& provenance, const Vector& translation);

  /// Adds numbers of the vertices, `each` of them per vertex: floats, or whole numbers as shares of their largest.
  /// Returns the accessor.
  template <class Number>
  std::size_t add_attribute(const std::string& name, const std::vector<Number>& values, std::size_t each) {
    static_assert(std::is_same_v<Number, float> || std::is_same_v<Number, std::uint16_t>);
    const std::size_t begin = bytes_.size();
    append(values);
    return add_accessor(name, begin, values.size() / each, each, std::is_same_v<Number, std::uint16_t>);
  }

  /// Adds an attribute with the values of another.
  void share_attribute(const std::string& name, std::size_t accessor) { attributes_[name] = accessor; }

  /// Adds a PNG as texture 0, without smaller versions of it.
  void add_picture(const std::string& png);

  /// Adds triangles that use all attributes added before.
  void add_primitive(const std::vector<std::uint32_t>& corners, nlohmann::ordered_json material);

  /// Adds to the extras of the asset.
  void add_extra(const std::string& key, const nlohmann::ordered_json& extra) { json_["asset"]["extras"][key] = extra; }

  /// \throws OutputError, also when the file would exceed the format's 4 GiB.
  void write(const std::filesystem::path& file);

 private:
  template <class Number>
  void append(const std::vector<Number>& values) {
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number));
  }
  std::size_t add_view(std::size_t begin, int target);
  std::size_t add_accessor(const std::string& name, std::size_t begin, std::size_t count, std::size_t each,
                           bool is_share);

  using Json = nlohmann::ordered_json;
  std::string bytes_;
  Json json_, attributes_, primitives_ = Json::array(), materials_ = Json::array();
  Json accessors_ = Json::array(), views_ = Json::array();
};

/// The material property of glTF for surfaces that show their color as it is.
nlohmann::ordered_json unlit();

/// Appends the triangles of a patch.
void append_patch(std::vector<std::uint32_t>& triangles, const std::array<std::uint32_t, 4>& corners);

}  // namespace patchlight
