#include "output/mesh/glb_file.h"

#include "patchlight/base/error.h"

#include "output/file/whole_file.h"
#include "output/mesh/write_mesh.h"
#include "output/report/report_json.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace patchlight {
namespace {

using GltfJson = nlohmann::ordered_json;

constexpr std::uint32_t glb_magic = 0x46546C67, glb_chunk_json = 0x4E4F534A, glb_chunk_binary = 0x004E4942;

// Numbers of the glTF 2.0 specification.
constexpr int type_float = 5126, type_unsigned_short = 5123, type_unsigned_int = 5125;
constexpr int target_vertices = 34962, target_indices = 34963;
constexpr int linear_filter = 9729, clamp_to_edge = 33071;

void append_chunk(std::string& bytes, std::uint32_t type, const std::string& chunk) {
  append_bytes(bytes, static_cast<std::uint32_t>(chunk.size()));
  append_bytes(bytes, type);
  bytes += chunk;
}

// To whole words.
std::string padded(std::string chunk, char with) {
  chunk.resize((chunk.size() + 3) / 4 * 4, with);
  return chunk;
}

}  // namespace

GlbFile::GlbFile(const Provenance& provenance, const Vector& translation) {
  json_["asset"] = {{"version", "2.0"},
                    {"generator", std::string("patchlight ") + version()},
                    {"extras", {{"exposure", provenance.exposure}, {"command_line", provenance.command_line}}}};
  json_["scene"] = 0;
  json_["scenes"] = GltfJson::array({{{"nodes", GltfJson::array({0})}}});
  json_["nodes"] = GltfJson::array({{{"mesh", 0}, {"translation", json_array(translation)}}});
}

std::size_t GlbFile::add_view(std::size_t begin, int target) {
  GltfJson json = {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes_.size() - begin}};
  if (target != 0) json["target"] = target;
  views_.push_back(std::move(json));
  bytes_ = padded(std::move(bytes_), '\0');
  return views_.size() - 1;
}

// Positions have bounds.
std::size_t GlbFile::add_accessor(const std::string& name, std::size_t begin, std::size_t count, std::size_t each,
                                  bool is_share) {
  GltfJson json = {{"bufferView", add_view(begin, target_vertices)},
                   {"componentType", is_share ? type_unsigned_short : type_float},
                   {"count", count},
                   {"type", "VEC" + std::to_string(each)}};
  if (is_share) json["normalized"] = true;
  if (name == "POSITION" && count > 0) {
    std::vector<float> values(count * each);
    std::memcpy(values.data(), bytes_.data() + begin, values.size() * sizeof(float));
    std::vector<float> lowest(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(each)), highest = lowest;
    for (std::size_t k = 0; k < values.size(); ++k) {
      lowest[k % each] = std::min(lowest[k % each], values[k]);
      highest[k % each] = std::max(highest[k % each], values[k]);
    }
    json["min"] = json_array(lowest);
    json["max"] = json_array(highest);
  }
  accessors_.push_back(std::move(json));
  attributes_[name] = accessors_.size() - 1;
  return accessors_.size() - 1;
}

void GlbFile::add_picture(const std::string& png) {
  const std::size_t begin = bytes_.size();
  bytes_ += png;
  json_["images"] = GltfJson::array({{{"bufferView", add_view(begin, 0)}, {"mimeType", "image/png"}}});
  json_["samplers"] = GltfJson::array({{{"magFilter", linear_filter},
                                        {"minFilter", linear_filter},
                                        {"wrapS", clamp_to_edge},
                                        {"wrapT", clamp_to_edge}}});
  json_["textures"] = GltfJson::array({{{"sampler", 0}, {"source", 0}}});
}

void GlbFile::add_primitive(const std::vector<std::uint32_t>& corners, GltfJson material) {
  const std::size_t begin = bytes_.size();
  append(corners);
  accessors_.push_back({{"bufferView", add_view(begin, target_indices)},
                        {"componentType", type_unsigned_int},
                        {"count", corners.size()},
                        {"type", "SCALAR"}});
  primitives_.push_back(
      {{"attributes", attributes_}, {"indices", accessors_.size() - 1}, {"material", materials_.size()}, {"mode", 4}});
  materials_.push_back(std::move(material));
}

void GlbFile::write(const std::filesystem::path& file) {
  const auto is_unlit = [](const GltfJson& material) { return material.contains("extensions"); };
  if (std::any_of(materials_.begin(), materials_.end(), is_unlit))
    json_["extensionsUsed"] = GltfJson::array({"KHR_materials_unlit"});
  json_["meshes"] = GltfJson::array({{{"primitives", primitives_}}});
  json_["materials"] = materials_;
  json_["accessors"] = accessors_;
  json_["bufferViews"] = views_;
  json_["buffers"] = GltfJson::array({{{"byteLength", bytes_.size()}}});

  // Bytes that are not UTF-8 are replaced.
  const std::string text = padded(json_.dump(-1, ' ', false, GltfJson::error_handler_t::replace), ' ');
  const std::size_t header = 12, chunk_header = 8;
  const std::size_t size = header + chunk_header + text.size() + chunk_header + bytes_.size();
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw OutputError(file.string(), "needs more than the 4 GiB that a .glb can hold; expected fewer patches or .vtp");
  std::string bytes;
  bytes.reserve(size);
  append_bytes(bytes, glb_magic);
  append_bytes(bytes, std::uint32_t{2});  // version of the container
  append_bytes(bytes, static_cast<std::uint32_t>(size));
  append_chunk(bytes, glb_chunk_json, text);
  append_chunk(bytes, glb_chunk_binary, bytes_);
  write_bytes(file, bytes);
}

GltfJson unlit() { return {{"KHR_materials_unlit", GltfJson::object()}}; }

void append_patch(std::vector<std::uint32_t>& triangles, const std::array<std::uint32_t, 4>& corners) {
  const auto& [a, b, c, d] = corners;
  triangles.insert(triangles.end(), {a, b, c});
  if (c != d) triangles.insert(triangles.end(), {a, c, d});
}

}  // namespace patchlight
