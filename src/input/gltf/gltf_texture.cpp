#include "input/gltf/gltf_texture.h"

#include "input/gltf/gltf_model.h"

#include <cmath>
#include <optional>

namespace patchlight {
namespace {

Wrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror : Wrap::repeat;
}

// KHR_texture_transform: scaled, turned about the origin counter-clockwise, as the picture is seen with v downwards,
// and moved.
struct TextureTransform {
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();
  std::optional<int> set;
};

Eigen::Vector2d pair_of(const tinygltf::Value& extension, const char* key, double otherwise) {
  Eigen::Vector2d pair(otherwise, otherwise);
  if (!extension.Has(key) || extension.Get(key).ArrayLen() < 2) return pair;
  for (int k = 0; k < 2; ++k) pair[k] = extension.Get(key).Get(static_cast<std::size_t>(k)).GetNumberAsDouble();
  return pair;
}

TextureTransform transform_of(const tinygltf::TextureInfo& texture) {
  TextureTransform transform;
  const auto found = texture.extensions.find("KHR_texture_transform");
  if (found == texture.extensions.end()) return transform;
  const tinygltf::Value& extension = found->second;
  const double angle = extension.Has("rotation") ? extension.Get("rotation").GetNumberAsDouble() : 0;
  Eigen::Matrix2d turn;
  turn << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
  transform.linear = turn * pair_of(extension, "scale", 1).asDiagonal();
  transform.offset = pair_of(extension, "offset", 0);
  if (extension.Has("texCoord")) transform.set = extension.Get("texCoord").GetNumberAsInt();
  return transform;
}

}  // namespace

std::array<Wrap, 2> gltf_wrap(const tinygltf::Model& model, int texture) {
  const int sampler = model.textures[static_cast<std::size_t>(texture)].sampler;
  if (sampler < 0 || static_cast<std::size_t>(sampler) >= model.samplers.size()) return {};
  const tinygltf::Sampler& stated = model.samplers[static_cast<std::size_t>(sampler)];
  return {wrap_of(stated.wrapS), wrap_of(stated.wrapT)};
}

std::vector<Eigen::Vector2d> gltf_places(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                         const tinygltf::TextureInfo& texture, const std::string& file) {
  const TextureTransform transform = transform_of(texture);
  const auto set = primitive.attributes.find("TEXCOORD_" + std::to_string(transform.set.value_or(texture.texCoord)));
  if (set == primitive.attributes.end()) return {};
  const std::vector<double> values = accessor_values(model, set->second, 2, file);
  std::vector<Eigen::Vector2d> places;
  for (std::size_t k = 0; k + 1 < values.size(); k += 2)
    places.emplace_back(transform.linear * Eigen::Vector2d(values[k], values[k + 1]) + transform.offset);
  return places;
}

}  // namespace patchlight
