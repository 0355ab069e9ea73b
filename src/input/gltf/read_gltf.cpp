#include "patchlight/base/error.h"
#include "patchlight/light/material.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/gltf/gltf_model.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/picture_colours.h"
#include "input/read_isolated.h"
#include "input/read_model.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

Spectrum color(const std::vector<double>& factor, double otherwise) {
  return factor.size() >= 3 ? rgb(factor[0], factor[1], factor[2]) : rgb(otherwise, otherwise, otherwise);
}

Spectrum color_factor(const tinygltf::Material& material) {
  return color(material.pbrMetallicRoughness.baseColorFactor, 1);
}

// The image of a texture; -1 without an image in core glTF 2.0.
int image_of(const tinygltf::Model& model, int texture) {
  const bool exists = texture >= 0 && static_cast<std::size_t>(texture) < model.textures.size();
  return exists ? model.textures[static_cast<std::size_t>(texture)].source : -1;
}

// The mean color of a texture; empty if unknown.
std::optional<Spectrum> texture_color(const GltfModel& gltf, int texture) {
  const auto found = gltf.mean_color.find(image_of(gltf.model, texture));
  if (found == gltf.mean_color.end()) return std::nullopt;
  return found->second;
}

Spectrum with_texture(const Spectrum& factor, const GltfModel& gltf, int texture) {
  const std::optional<Spectrum> mean = texture_color(gltf, texture);
  return mean ? Spectrum(factor * *mean) : factor;
}

// A number of a material extension, or `otherwise` if absent.
double number_of(const tinygltf::Material& material, const char* extension, const char* key, double otherwise) {
  const auto found = material.extensions.find(extension);
  if (found == material.extensions.end() || !found->second.Has(key)) return otherwise;
  return found->second.Get(key).GetNumberAsDouble();
}

// KHR_materials_transmission.
double transmission(const tinygltf::Material& material) {
  return std::clamp(number_of(material, "KHR_materials_transmission", "transmissionFactor", 0), 0.0, 1.0);
}

// The alpha of the base color texture; null if opaque or unknown.
const AlphaColours* alpha_picture(const GltfModel& gltf, const tinygltf::Material& material) {
  const int image = image_of(gltf.model, material.pbrMetallicRoughness.baseColorTexture.index);
  const auto found = gltf.alpha.find(image);
  return found == gltf.alpha.end() ? nullptr : found->second.get();
}

double alpha_factor(const tinygltf::Material& material) {
  const std::vector<double>& factor = material.pbrMetallicRoughness.baseColorFactor;
  return factor.size() == 4 ? std::clamp(factor[3], 0.0, 1.0) : 1;
}

// The texture cuts out the surface: glTF 2.0 section 3.9.4.
bool is_cut_out(const GltfModel& gltf, const tinygltf::Material& material) {
  const bool heeds_alpha = material.alphaMode == "MASK" || material.alphaMode == "BLEND";
  return heeds_alpha && alpha_picture(gltf, material);
}

// The covered part of the surface and its color: pixels with alpha at or above the cutoff, or each pixel by its alpha.
Coverage cut_out_coverage(const GltfModel& gltf, const tinygltf::Material& material) {
  const double factor = alpha_factor(material);
  const bool is_mask = material.alphaMode == "MASK";
  return coverage_by(*alpha_picture(gltf, material), [&](double alpha) {
    if (is_mask) return alpha * factor >= material.alphaCutoff ? 1.0 : 0.0;
    return alpha * factor;
  });
}

// The covered fraction of the surface. A mask without a texture counts as fully covered.
double covered_share(const GltfModel& gltf, const tinygltf::Material& material) {
  if (is_cut_out(gltf, material)) return cut_out_coverage(gltf, material).share;
  return material.alphaMode == "BLEND" ? alpha_factor(material) : 1;
}

// KHR_materials_ior; default 1.5.
double index_of(const tinygltf::Material& material) {
  return plausible_index(number_of(material, "KHR_materials_ior", "ior", 1.5), 1.5);
}

// "transmissionFactor 0.9", "alpha 0.3", or both.
std::string statement_of(double transmitted, double covered, bool by_picture) {
  const std::string factor = transmitted > 0 ? "transmissionFactor " + rounded(transmitted) : "";
  const std::string alpha =
      covered < 1 ? (by_picture ? "alpha of its picture covers " : "alpha ") + rounded(covered) : "";
  return factor + (factor.empty() || alpha.empty() ? "" : " and ") + alpha;
}

bool is_clear(const GltfModel& gltf, const tinygltf::Material& material) {
  return transmission(material) > 0 || covered_share(gltf, material) < 1;
}

// A smooth metal. Both factors default to 1.
bool is_mirror(const GltfModel& gltf, const tinygltf::Material& material) {
  const tinygltf::PbrMetallicRoughness& surface = material.pbrMetallicRoughness;
  return surface.metallicFactor >= least_metallic && surface.roughnessFactor <= most_roughness &&
         surface.metallicRoughnessTexture.index < 0 && !is_clear(gltf, material);
}

// glTF 2.0 appendix B.2: a metal reflects its base color specularly and has no diffuse reflection.
Material with_metal(Material material, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const Spectrum color = material.reflectance;
  return as_mirror(
      std::move(material), color, Spectrum::Zero(color.size()),
      "metallicFactor " + rounded(surface.metallicFactor) + " and roughnessFactor " + rounded(surface.roughnessFactor));
}

// KHR_materials_transmission: the covered part transmits a fraction of the base color and reflects the rest diffusely.
// The reflection of the glass surfaces limits the transmittance. Holes alone have index 1.
Material with_transparency(Material material, const GltfModel& gltf, const tinygltf::Material& read) {
  const double transmitted = transmission(read);
  const bool by_picture = is_cut_out(gltf, read);
  const double covered = covered_share(gltf, read);
  const double index = by_picture && transmitted == 0 ? 1 : index_of(read);
  const Spectrum surface =
      by_picture ? Spectrum(color_factor(read) * cut_out_coverage(gltf, read).colour) : material.reflectance;
  const Spectrum color = surface.min(1);
  const Spectrum clear = (transmitted * color).min(highest_transmittance(index));
  Material pane = as_pane(std::move(material), 1 - covered + covered * clear, index,
                          statement_of(transmitted, covered, by_picture));
  pane.reflectance = covered * (1 - transmitted) * color;
  pane.stated_pane->matt_exitance = pane.exitance;
  pane.exitance *= covered;
  return pane;
}

// The base color texture, if it has more than one color.
std::optional<TexturedReflectance> textured(const GltfModel& gltf, const tinygltf::Material& read) {
  const tinygltf::PbrMetallicRoughness& surface = read.pbrMetallicRoughness;
  const auto found = gltf.textures.find(image_of(gltf.model, surface.baseColorTexture.index));
  if (found == gltf.textures.end()) return std::nullopt;
  return TexturedReflectance{found->second, primaries_times(color_factor(read)),
                             gltf_wrap(gltf.model, surface.baseColorTexture.index)};
}

// A diffuse material: the reflectance is the base color, the radiance in W/(m^2 sr) the emissive factor times the
// emissive strength. Decoded textures contribute their mean color. Materials with transmission, or blended with alpha
// below 1, become panes; smooth metals become mirrors.
Material material_from(const GltfModel& gltf, const tinygltf::Material& read) {
  const int picture = read.pbrMetallicRoughness.baseColorTexture.index;
  const double strength = number_of(read, "KHR_materials_emissive_strength", "emissiveStrength", 1);
  const Spectrum radiance = strength * color(read.emissiveFactor, 0);
  // Exitance = pi radiance for a Lambertian emitter.
  Material material{read.name, with_texture(color_factor(read), gltf, picture),
                    std::numbers::pi * with_texture(radiance, gltf, read.emissiveTexture.index)};
  material.texture = textured(gltf, read);
  if (is_mirror(gltf, read)) return with_metal(std::move(material), read);
  return is_clear(gltf, read) ? with_transparency(std::move(material), gltf, read) : material;
}

// The base color and emissive textures that exist.
std::vector<int> colored_textures(const tinygltf::Material& material) {
  std::vector<int> textures;
  for (const int texture : {material.pbrMetallicRoughness.baseColorTexture.index, material.emissiveTexture.index}) {
    if (texture >= 0) textures.push_back(texture);
  }
  return textures;
}

bool is_matt_metal(const GltfModel& gltf, const tinygltf::Material& material) {
  return material.pbrMetallicRoughness.metallicFactor > 0 && !is_mirror(gltf, material);
}

// Transparency by a transmission texture, or by a texture that could not be read.
bool has_unknown_holes(const GltfModel& gltf, const tinygltf::Material& material) {
  const auto found = material.extensions.find("KHR_materials_transmission");
  if (found != material.extensions.end() && found->second.Has("transmissionTexture")) return true;
  if (material.alphaMode != "MASK" && material.alphaMode != "BLEND") return false;
  const int picture = material.pbrMetallicRoughness.baseColorTexture.index;
  return picture >= 0 && !texture_color(gltf, picture);
}

// The alpha factor alone would mask away the whole surface; the cutoff is probably unintended.
bool is_masked_away(const GltfModel& gltf, const tinygltf::Material& material) {
  const bool is_gone = material.alphaMode == "MASK" && alpha_factor(material) < material.alphaCutoff;
  return is_gone && !is_cut_out(gltf, material) && !has_unknown_holes(gltf, material);
}

std::string name_of_material(const tinygltf::Model& model, std::size_t m) {
  const std::string& name = model.materials[m].name;
  return name.empty() ? "material " + std::to_string(m) : name;
}

using GltfProperty = std::function<bool(const GltfModel&, const tinygltf::Material&)>;

std::vector<std::string> names_with(const GltfModel& gltf, const GltfProperty& property) {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < gltf.model.materials.size(); ++m)
    if (property(gltf, gltf.model.materials[m])) names.push_back(name_of_material(gltf.model, m));
  return names;
}

// Covered fractions of cut-out materials: "leaves (0.42)".
std::vector<std::string> covered_shares(const GltfModel& gltf) {
  std::vector<std::string> names;
  for (std::size_t m = 0; m < gltf.model.materials.size(); ++m) {
    const tinygltf::Material& material = gltf.model.materials[m];
    if (!is_cut_out(gltf, material) || covered_share(gltf, material) >= 1) continue;
    names.push_back(name_of_material(gltf.model, m) + " (" + rounded(covered_share(gltf, material)) + ")");
  }
  return names;
}

// Numbers of rough metals, and of materials with unknown transparency.
std::vector<UnsimulatedMaterials> unsimulated(const GltfModel& gltf) {
  return counted(names_with(gltf, is_matt_metal).size(),
                 names_with(gltf, has_unknown_holes).size() + names_with(gltf, is_masked_away).size());
}

// One sentence per material property that the simulation ignores or simplifies.
Diagnostics notes_on_materials(const GltfModel& gltf) {
  Diagnostics notes;
  const auto name = [&](DiagnosticCode code, const std::string& sentence, const std::vector<std::string>& names) {
    notes = merged({std::move(notes), note_on(code, sentence, names)});
  };
  const auto note = [&](DiagnosticCode code, const std::string& sentence, const GltfProperty& property) {
    name(code, sentence, names_with(gltf, property));
  };
  const auto has_texture = [&](bool is_decoded) {
    return [is_decoded](const GltfModel& of, const tinygltf::Material& material) {
      for (const int texture : colored_textures(material)) {
        if (texture_color(of, texture).has_value() == is_decoded) return true;
      }
      return false;
    };
  };
  const auto is_used_whole = [](const GltfModel& of, const tinygltf::Material& material) {
    const bool has_place = !is_clear(of, material) && !is_mirror(of, material);
    const bool has_mean = texture_color(of, material.pbrMetallicRoughness.baseColorTexture.index).has_value();
    return (has_mean && !has_place) || texture_color(of, material.emissiveTexture.index).has_value();
  };
  note(DiagnosticCode::simplified_picture, "textures of lamps, panes and mirrors are replaced by their mean color",
       is_used_whole);
  for (const auto& [image, fault] : gltf.picture_faults) {
    const tinygltf::Image& found = gltf.model.images[static_cast<std::size_t>(image)];
    const std::string& uri = found.uri.empty() ? found.name : found.uri;
    notes.push_back(
        {DiagnosticCode::unreadable_picture,
         "image " + std::to_string(image) + (uri.empty() ? "" : " (" + uri.substr(0, 80) + ")") + " " + fault});
  }
  note(DiagnosticCode::unreadable_picture, "unreadable textures are ignored; only the color factor is used",
       has_texture(false));
  note(DiagnosticCode::simplified_part, "metallic surfaces are simulated as matt surfaces of their base color",
       is_matt_metal);
  name(DiagnosticCode::cut_out_material, covered_note, covered_shares(gltf));
  note(DiagnosticCode::simplified_part, "transparency by textures is ignored; only factors are used",
       has_unknown_holes);
  note(DiagnosticCode::simplified_part, "masks that remove a whole surface are ignored: it is opaque", is_masked_away);
  return notes;
}

// glTF 2.0 section 3.5.3: local transformation of a node, as a column-major matrix or T R S.
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

// Corners of the triangles of a primitive, glTF 2.0 section 3.7.2.1. Empty for points and lines.
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
    // The last material is the default of primitives.
    scene_.materials.push_back(default_material());
  }

  void add_node(int index, const Eigen::Matrix4d& above) {
    const bool exists = index >= 0 && static_cast<std::size_t>(index) < model_.nodes.size();
    // Section 3.5.2: a node has at most one parent. A few nodes that break this rule could be added millions of times.
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
    const auto note = [&](DiagnosticCode code, const char* what, std::size_t count) {
      if (count > 0) scene_.diagnostics.push_back({code, what + std::to_string(count), count});
    };
    note(DiagnosticCode::assumed_material,
         "parts without a material, which get the material 'default' (reflectance 0.5): ", without_material_);
    note(DiagnosticCode::simplified_part, "parts with vertex colors, which are ignored: ", colored_);
    scene_.texture_maps = mapped_.maps();
    scene_.diagnostics = merged({std::move(scene_.diagnostics), mapped_.notes()});
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
    // Section 3.7.4: a reflection reverses the winding, so that the front stays the front.
    const bool mirrored = to_scene.topLeftCorner<3, 3>().determinant() < 0;
    if (shines_on_both_sides(polygon.material)) polygon.back_material = polygon.material;
    const bool is_textured = scene_.materials[polygon.material].texture.has_value();
    const std::vector<Eigen::Vector2d> places = is_textured ? places_of(primitive) : std::vector<Eigen::Vector2d>{};
    for (std::array<std::uint32_t, 3> triangle : triangles_of(corners_of(primitive, count), mode)) {
      if (mirrored) std::swap(triangle[1], triangle[2]);
      polygon.corners = {first + triangle[0], first + triangle[1], first + triangle[2]};
      if (is_textured) polygon.texture_map = mapped_.add(scene_.vertices, polygon.corners, first, places);
      if (polygon.back_material) polygon.back_texture_map = polygon.texture_map;
      scene_.polygons.push_back(polygon);
    }
    colored_ += primitive.attributes.count("COLOR_0");
  }

  // glTF 2.0 section 3.9.6: the back of a double-sided material emits like the front.
  bool shines_on_both_sides(MaterialIndex m) const {
    const Material& material = scene_.materials[m];
    const bool is_clear = material.transmittance.size() > 0 && (material.transmittance > 0).any();
    return m < model_.materials.size() && model_.materials[m].doubleSided && (material.exitance > 0).any() && !is_clear;
  }

  std::vector<Eigen::Vector2d> places_of(const tinygltf::Primitive& primitive) const {
    const auto& material = model_.materials[static_cast<std::size_t>(primitive.material)];
    return gltf_places(model_, primitive, material.pbrMetallicRoughness.baseColorTexture, scene_.file);
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

// The root nodes of the default scene; without scenes, all nodes without a parent.
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
  for (const tinygltf::Material& read : gltf.model.materials) scene.materials.push_back(material_from(gltf, read));
  if (!gltf.model.animations.empty() || !gltf.model.skins.empty())
    scene.diagnostics.push_back(
        {DiagnosticCode::simplified_part, "animations and skins are ignored: the model keeps its rest pose"});
  scene = with_lost_lights(std::move(scene), gltf.model);

  // 2. The triangles, in meters: glTF 2.0 section 3.4 fixes the unit and that +y is up.
  Eigen::Matrix4d to_scene = Eigen::Matrix4d::Identity();
  to_scene.topLeftCorner<3, 3>() *= metres_per_unit;
  GltfCollector collector(gltf.model, std::move(scene));
  for (const int node : top_nodes(gltf.model)) collector.add_node(node, to_scene);
  scene = with_used_materials(std::move(collector).scene());
  scene.metres_per_unit = metres_per_unit;
  scene.up = Vector::UnitY();
  scene.up_stated = true;

  // 3. Properties that are not simulated.
  scene.unsimulated = unsimulated(gltf);
  scene.diagnostics = merged({std::move(scene.diagnostics), notes_on_materials(gltf)});
  return scene;
}

}  // namespace

Scene read_gltf(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  // tinygltf recurses for each level of the JSON. Decoding pictures takes time and memory.
  constexpr ChildLimits limits = {.seconds = 180, .bytes = std::uint64_t{4} << 30U};
  return read_isolated(
      file.string(), [&] { return scene_of(file, metres_per_unit, confine); }, limits);
}

}  // namespace patchlight
