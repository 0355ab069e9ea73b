#pragma once

#include "number_at.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

// Binary glTF, read by the specification.
namespace patchlight::test {

// The parts of a .glb file.
struct Glb {
  nlohmann::json json;
  std::string binary;
};

// The container of the glTF 2.0 specification, section 4.4: a header of 12 bytes, then chunks of length, type and data,
// each a multiple of four bytes.
inline Glb taken_apart(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 4), 2U);
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 8), bytes.size());
  const std::size_t json_size = number_at<std::uint32_t>(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(json_size % 4, 0U);
  const std::size_t binary_size = number_at<std::uint32_t>(bytes, 20 + json_size);
  EXPECT_EQ(bytes.substr(24 + json_size, 4), std::string("BIN\0", 4));
  EXPECT_EQ(binary_size % 4, 0U);
  EXPECT_EQ(28 + json_size + binary_size, bytes.size());
  return {nlohmann::json::parse(bytes.substr(20, json_size)), bytes.substr(28 + json_size)};
}

inline std::size_t component_size(int type) {
  // 5120 to 5126: byte, unsigned byte, short, unsigned short, none, unsigned int, float.
  constexpr std::array<std::size_t, 7> sizes = {1, 1, 2, 2, 0, 4, 4};
  return sizes.at(static_cast<std::size_t>(type - 5120));
}

inline std::size_t component_count(const std::string& type) {
  return std::map<std::string, std::size_t>{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}.at(type);
}

// The numbers of an accessor of floats or of unsigned ints.
inline std::vector<double> values_of(const Glb& glb, const nlohmann::json& accessor) {
  const nlohmann::json& view = glb.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
  const int type = accessor["componentType"];
  const std::size_t count = accessor["count"].get<std::size_t>() * component_count(accessor["type"]);
  const std::size_t begin = view["byteOffset"].get<std::size_t>() + accessor.value("byteOffset", std::size_t{0});
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = begin + k * component_size(type);
    values.push_back(type == 5126   ? static_cast<double>(number_at<float>(glb.binary, at))
                     : type == 5123 ? number_at<std::uint16_t>(glb.binary, at)
                                    : number_at<std::uint32_t>(glb.binary, at));
  }
  return values;
}

// Buffers and views: section 3.6 of the glTF 2.0 specification; the binary chunk: 4.4.3.3.
inline void expect_valid_buffers(const Glb& glb) {
  const std::size_t length = glb.json["buffers"].at(0)["byteLength"];
  EXPECT_EQ(glb.json["buffers"].size(), 1U);
  EXPECT_LE(length, glb.binary.size());
  EXPECT_LE(glb.binary.size(), length + 3);
  for (const auto& view : glb.json["bufferViews"]) {
    EXPECT_EQ(view["buffer"], 0);
    EXPECT_GE(view["byteLength"], 1);
    EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), length);
    EXPECT_FALSE(view.contains("byteStride"));
  }
  for (const auto& accessor : glb.json["accessors"]) {
    const auto& view = glb.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
    const std::size_t size = component_size(accessor["componentType"]);
    EXPECT_EQ(view["byteOffset"].get<std::size_t>() % size, 0U);
    const std::size_t element = size * component_count(accessor["type"]);
    if (view["target"] == 34962) {
      EXPECT_EQ(element % 4, 0U);
    }
    EXPECT_GE(accessor["count"], 1);
    EXPECT_EQ(accessor["count"].get<std::size_t>() * element, view["byteLength"].get<std::size_t>());
    if (accessor["componentType"] == 5126) {
      for (const double value : values_of(glb, accessor)) ASSERT_TRUE(std::isfinite(value));
    }
  }
}

// Section 3.7.2: attributes of equal count, numbered ones from 0, bounds of positions, unit normals, indices in range.
inline void expect_valid_primitive(const Glb& glb, const nlohmann::json& primitive) {
  const auto& accessors = glb.json["accessors"];
  const auto& attributes = primitive["attributes"];
  const auto& positions = accessors.at(attributes["POSITION"].get<std::size_t>());
  for (const auto& [name, index] : attributes.items()) {
    const auto& accessor = accessors.at(index.get<std::size_t>());
    EXPECT_EQ(accessor["count"], positions["count"]) << name;
    EXPECT_EQ(glb.json["bufferViews"].at(accessor["bufferView"].get<std::size_t>())["target"], 34962);
  }
  if (attributes.contains("TEXCOORD_1")) {
    EXPECT_TRUE(attributes.contains("TEXCOORD_0"));
  }
  const std::vector<double> places = values_of(glb, positions);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double lowest = places[axis], highest = places[axis];
    for (std::size_t k = axis; k < places.size(); k += 3) {
      lowest = std::min(lowest, places[k]);
      highest = std::max(highest, places[k]);
    }
    EXPECT_EQ(positions["min"].at(axis).get<double>(), lowest);
    EXPECT_EQ(positions["max"].at(axis).get<double>(), highest);
  }
  if (attributes.contains("NORMAL")) {
    const std::vector<double> normals = values_of(glb, accessors.at(attributes["NORMAL"].get<std::size_t>()));
    for (std::size_t k = 0; k < normals.size(); k += 3)
      ASSERT_NEAR(std::hypot(normals[k], normals[k + 1], normals[k + 2]), 1, 1e-6);
  }
  const auto& indices = accessors.at(primitive["indices"].get<std::size_t>());
  EXPECT_EQ(indices["type"], "SCALAR");
  EXPECT_EQ(indices["count"].get<std::size_t>() % 3, 0U);  // triangles
  EXPECT_EQ(glb.json["bufferViews"].at(indices["bufferView"].get<std::size_t>())["target"], 34963);
  for (const double index : values_of(glb, indices)) ASSERT_LT(index, positions["count"].get<double>());
  EXPECT_LT(primitive["material"].get<std::size_t>(), glb.json["materials"].size());
  EXPECT_EQ(primitive["mode"], 4);
}

// Sections 3.8 and 3.9: textures in their own buffer views, and declared extensions.
inline void expect_valid_materials(const Glb& glb) {
  bool has_extension = false;
  for (const auto& material : glb.json["materials"]) {
    const auto& surface = material["pbrMetallicRoughness"];
    has_extension = has_extension || material.contains("extensions");
    if (surface.contains("baseColorFactor")) {
      ASSERT_EQ(surface["baseColorFactor"].size(), 4U);
      for (const double factor : surface["baseColorFactor"]) EXPECT_TRUE(factor >= 0 && factor <= 1);
    }
    if (!surface.contains("baseColorTexture")) continue;
    const auto& texture = glb.json["textures"].at(surface["baseColorTexture"]["index"].get<std::size_t>());
    EXPECT_LT(texture["sampler"].get<std::size_t>(), glb.json["samplers"].size());
    const auto& image = glb.json["images"].at(texture["source"].get<std::size_t>());
    const auto& view = glb.json["bufferViews"].at(image["bufferView"].get<std::size_t>());
    EXPECT_FALSE(view.contains("target"));
    EXPECT_EQ(image["mimeType"], "image/png");
    EXPECT_EQ(glb.binary.substr(view["byteOffset"], 8), "\x89PNG\r\n\x1a\n");
  }
  EXPECT_EQ(glb.json.contains("extensionsUsed"), has_extension);
}

// The checks of a glTF 2.0 validator for files of this kind.
inline void expect_valid(const Glb& glb) {
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  expect_valid_buffers(glb);
  std::vector<bool> is_used(glb.json["accessors"].size());
  for (const auto& primitive : glb.json["meshes"].at(0)["primitives"]) {
    expect_valid_primitive(glb, primitive);
    is_used.at(primitive["indices"].get<std::size_t>()) = true;
    for (const auto& attribute : primitive["attributes"]) is_used.at(attribute.get<std::size_t>()) = true;
  }
  for (const bool used : is_used) EXPECT_TRUE(used);
  expect_valid_materials(glb);
}

}  // namespace patchlight::test
