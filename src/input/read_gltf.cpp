#include "input/read_gltf.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/gltf_material.h"
#include "input/gltf_model.h"
#include "input/gltf_texture.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/scene_bytes.h"
#include "input/texture_maps.h"

#include <array>

namespace patchlight {
namespace {

// glTF 2.0 section 3.5.3: a node's own transformation, as a matrix by columns or as T R S.
Eigen::Matrix4d transformation(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3) result.translate(Eigen::Map<const Vector>(node.translation.data()));
  if (node.rotation.size() == 4) {  // x, y, z, w
    const Eigen::Quaterniond turn(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (turn.norm() > 0) result.rotate(turn.normalized());
  }
  if (node.scale.size() == 3) result.scale(Vector(Eigen::Map<const Vector>(node.scale.data())));
  return result.matrix();
}

// The corners of the triangles of a primitive: glTF 2.0 section 3.7.2.1. Empty for points and lines.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const std::vector<std::uint32_t>& corners, int mode) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    if (mode == TINYGLTF_MODE_TRIANGLES && k % 3 == 2) {
      triangles.push_back({corners[k - 2], corners[k - 1], corners[k]});
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      const std::size_t odd = k % 2;
      triangles.push_back({corners[k - 2], corners[k - 1 + odd], corners[k - odd]});
    } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  return triangles;
}

// Collects the triangles of all nodes.
class GltfCollector {
 public:
  GltfCollector(const tinygltf::Model& model, Scene scene)
      : model_(model), scene_(std::move(scene)), mapped_(scene_.file), is_added_(model.nodes.size(), 0) {
    // The last material is the one of primitives without a material.
    scene_.materials.push_back(default_material());
  }

  void add_node(int index, const Eigen::Matrix4d& above) {
    const bool exists = index >= 0 && static_cast<std::size_t>(index) < model_.nodes.size();
    // Section 3.5.2: no node is below two others. A few that are, below each other, would be added millions of times.
    if (!exists || is_added_[static_cast<std::size_t>(index)]) {
      throw InputError(scene_.file,
                       "node " + std::to_string(index) +
                           " is missing, or there twice, in the tree of nodes\nhint: export the model again");
    }
    is_added_[static_cast<std::size_t>(index)] = 1;
    const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
    const Eigen::Matrix4d to_scene = above * transformation(node);
    if (node.mesh >= 0) add_mesh(node, index, to_scene);
    for (const int child : node.children) add_node(child, to_scene);
  }

  Scene scene() && {
    const auto note = [&](const char* what, std::size_t count) {
      if (count > 0) scene_.notes.push_back(what + std::to_string(count));
    };
    note("parts without a material, which get the material 'default' (reflectance 0.5): ", without_material_);
    note("parts with vertex colours, which are ignored: ", colored_);
    scene_.texture_maps = mapped_.maps();
    for (std::string& sentence : mapped_.notes()) scene_.notes.push_back(std::move(sentence));
    return left_out_.on(std::move(scene_));
  }

 private:
  void add_mesh(const tinygltf::Node& node, int index, const Eigen::Matrix4d& to_scene) {
    if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size()) {
      throw InputError(scene_.file, "names mesh " + std::to_string(node.mesh) + ", which is not in the file");
    }
    const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    const std::string& name = node.name.empty() ? mesh.name : node.name;
    scene_.groups.push_back(name.empty() ? "node " + std::to_string(index) : name);
    for (const tinygltf::Primitive& primitive : mesh.primitives) add_primitive(primitive, to_scene);
  }

  void add_primitive(const tinygltf::Primitive& primitive, const Eigen::Matrix4d& to_scene) {
    const auto positions = primitive.attributes.find("POSITION");
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    const std::string& object = scene_.groups.back();
    if (mode < TINYGLTF_MODE_TRIANGLES)
      return left_out_.lose_without_area("parts of points or lines, left out", object);
    if (positions == primitive.attributes.end())
      return left_out_.lose_face("parts without positions of their vertices, left out", object);
    const std::vector<double> values = accessor_values(model_, positions->second, 3, scene_.file);
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    const auto count = static_cast<std::uint32_t>(values.size() / 3);
    for (std::size_t v = 0; v < count; ++v) {
      const Eigen::Vector4d position(values[3 * v], values[3 * v + 1], values[3 * v + 2], 1);
      scene_.vertices.emplace_back((to_scene * position).head<3>());
    }
    Polygon polygon;
    polygon.material = material_of(primitive);
    polygon.group = static_cast<std::uint32_t>(scene_.groups.size() - 1);
    // Section 3.7.4: a transformation that mirrors turns the winding round, so that the front stays the front.
    const bool mirrored = to_scene.topLeftCorner<3, 3>().determinant() < 0;
    if (shines_on_both_sides(polygon.material)) polygon.back_material = polygon.material;
    const bool is_textured = scene_.materials[polygon.material].texture.has_value();
    const std::vector<Eigen::Vector2d> places = is_textured ? places_of(primitive) : std::vector<Eigen::Vector2d>{};
    for (std::array<std::uint32_t, 3> triangle : triangles_of(corners_of(primitive, count), mode)) {
      if (mirrored) std::swap(triangle[1], triangle[2]);
      polygon.corners = {first + triangle[0], first + triangle[1], first + triangle[2]};
      if (is_textured) polygon.texture_map = mapped(triangle, first, places);
      if (polygon.back_material) polygon.back_texture_map = polygon.texture_map;
      scene_.polygons.push_back(polygon);
    }
    colored_ += primitive.attributes.count("COLOR_0");
  }

  // glTF 2.0 section 3.9.6: the back of a double-sided material emits as the front does.
  bool shines_on_both_sides(MaterialIndex m) const {
    const Material& material = scene_.materials[m];
    const bool is_clear = material.transmittance.size() > 0 && (material.transmittance > 0).any();
    return m < model_.materials.size() && model_.materials[m].doubleSided && (material.exitance > 0).any() && !is_clear;
  }

  std::vector<Eigen::Vector2d> places_of(const tinygltf::Primitive& primitive) const {
    const auto& material = model_.materials[static_cast<std::size_t>(primitive.material)];
    return gltf_places(model_, primitive, material.pbrMetallicRoughness.baseColorTexture, scene_.file);
  }

  std::uint32_t mapped(const std::array<std::uint32_t, 3>& triangle, std::uint32_t first,
                       const std::vector<Eigen::Vector2d>& places) {
    std::vector<Point> corners;
    std::vector<Eigen::Vector2d> in_picture;
    for (const std::uint32_t vertex : triangle) {
      corners.push_back(scene_.vertices[first + vertex]);
      if (vertex < places.size()) in_picture.push_back(places[vertex]);
    }
    return mapped_.add(corners, in_picture, 0);
  }

  MaterialIndex material_of(const tinygltf::Primitive& primitive) {
    const auto last = static_cast<MaterialIndex>(scene_.materials.size() - 1);
    if (primitive.material >= 0 && static_cast<MaterialIndex>(primitive.material) < last) {
      return static_cast<MaterialIndex>(primitive.material);
    }
    ++without_material_;
    return last;
  }

  // The vertices of a primitive in drawing order.
  std::vector<std::uint32_t> corners_of(const tinygltf::Primitive& primitive, std::uint32_t vertices) const {
    std::vector<std::uint32_t> corners;
    if (primitive.indices < 0) {
      for (std::uint32_t v = 0; v < vertices; ++v) corners.push_back(v);
      return corners;
    }
    for (const double index : accessor_values(model_, primitive.indices, 1, scene_.file)) {
      if (!(index >= 0 && index < vertices)) {
        throw InputError(scene_.file, "a triangle names a vertex that is not there\nhint: export the model again");
      }
      corners.push_back(static_cast<std::uint32_t>(index));
    }
    return corners;
  }

  const tinygltf::Model& model_;
  Scene scene_;
  MappedFaces mapped_;
  std::vector<std::uint8_t> is_added_;  // per node
  std::size_t without_material_ = 0;
  LeftOut left_out_;
  std::size_t colored_ = 0;
};

// The nodes at the top of the scene to show; without any scene, all nodes that have no node above.
std::vector<int> top_nodes(const tinygltf::Model& model) {
  if (!model.scenes.empty()) {
    const auto chosen = static_cast<std::size_t>(std::max(0, model.defaultScene));
    return model.scenes[std::min(chosen, model.scenes.size() - 1)].nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
        is_child[static_cast<std::size_t>(child)] = true;
    }
  }
  std::vector<int> tops;
  for (std::size_t k = 0; k < is_child.size(); ++k) {
    if (!is_child[k]) tops.push_back(static_cast<int>(k));
  }
  return tops;
}

std::vector<std::string> notes_on_model(const tinygltf::Model& model) {
  std::vector<std::string> notes;
  if (!model.animations.empty() || !model.skins.empty()) {
    notes.emplace_back("animations and skins are ignored: the model is taken as it stands");
  }
  return notes;
}

Scene with_lost_lights(Scene scene, const tinygltf::Model& model) {
  LeftOut lost;
  for (const tinygltf::Light& light : model.lights)
    lost.lose("lights without a surface, which are not read from glTF, left out", light.type + " light " + light.name);
  return lost.on(std::move(scene));
}

Scene scene_of(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  // 1. The file, its buffers and pictures, and the materials.
  const GltfModel gltf = read_gltf_model(file, confine);
  Scene scene;
  scene.file = file.string();
  scene.sha256 = sha256(gltf.files.bytes);
  scene.inputs = gltf.files.names;
  scene.materials = gltf_materials(gltf);
  scene.notes = notes_on_model(gltf.model);
  scene = with_lost_lights(std::move(scene), gltf.model);

  // 2. The triangles, in metres: glTF 2.0 section 3.4 fixes the unit and that +y is up.
  Eigen::Matrix4d to_scene = Eigen::Matrix4d::Identity();
  to_scene.topLeftCorner<3, 3>() *= metres_per_unit;
  GltfCollector collector(gltf.model, std::move(scene));
  for (const int node : top_nodes(gltf.model)) collector.add_node(node, to_scene);
  scene = with_used_materials(std::move(collector).scene());
  scene.metres_per_unit = metres_per_unit;
  scene.up = Vector::UnitY();
  scene.up_stated = true;

  // 3. What is not simulated.
  scene.unsimulated = unsimulated(gltf);
  for (std::string& note : notes_on_materials(gltf)) scene.notes.push_back(std::move(note));
  return scene;
}

}  // namespace

Scene read_gltf(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  // tinygltf calls itself for each level of the JSON. Pictures, in files of their own, take time and memory to decode.
  constexpr ChildLimits limits = {.seconds = 180, .bytes = std::uint64_t{4} << 30U};
  return read_isolated(
      file.string(), [&] { return scene_of(file, metres_per_unit, confine); }, limits);
}

}  // namespace patchlight
