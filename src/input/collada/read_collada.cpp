#include "patchlight/base/error.h"
#include "patchlight/light/material.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "files/reason.h"
#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/picture_colours.h"
#include "input/read_isolated.h"
#include "input/read_model.h"
#include "input/text.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// The texture of the diffuse color of an assimp material.
struct AssimpPicture {
  std::string file;      // as the model names it, relative to its folder
  unsigned int set = 0;  // index of the texture coordinates of the meshes
  std::array<Wrap, 2> wrap{};
};

// Textures by index of material.
using AssimpPictures = std::map<unsigned int, AssimpPicture>;

Wrap wrap_of_mode(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Mirror) return Wrap::mirror;
  return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? Wrap::clamp : Wrap::repeat;
}

std::optional<AssimpPicture> diffuse_picture(const aiMaterial& material, const std::filesystem::path& folder) {
  aiString name;
  unsigned int set = 0;
  std::array<aiTextureMapMode, 3> modes = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name, nullptr, &set, nullptr, nullptr, modes.data()) !=
      aiReturn_SUCCESS)
    return std::nullopt;
  std::string file = name.C_Str();
  std::replace(file.begin(), file.end(), '\\', '/');
  return AssimpPicture{(folder / file).string(), set, {wrap_of_mode(modes[0]), wrap_of_mode(modes[1])}};
}

AssimpPictures diffuse_pictures(const aiScene& model, const std::filesystem::path& folder) {
  AssimpPictures pictures;
  for (unsigned int m = 0; m < model.mNumMeshes; ++m) {
    const unsigned int material = model.mMeshes[m]->mMaterialIndex;
    const std::optional<AssimpPicture> picture = diffuse_picture(*model.mMaterials[material], folder);
    if (picture) pictures.emplace(material, *picture);
  }
  return pictures;
}

std::vector<Eigen::Vector2d> places_in(const AssimpPicture& picture, const aiMesh& mesh) {
  std::vector<Eigen::Vector2d> places;
  if (picture.set >= AI_MAX_NUMBER_OF_TEXTURECOORDS || !mesh.HasTextureCoords(picture.set)) return places;
  for (unsigned int v = 0; v < mesh.mNumVertices; ++v) {
    const aiVector3D& place = mesh.mTextureCoords[picture.set][v];
    places.emplace_back(place.x, 1.0 - place.y);
  }
  return places;
}

// Panes use the mean of their texture.
Material painted(Material material, const Spectrum& mean, const std::shared_ptr<const Texture>& texture) {
  material.reflectance = mean;
  if (material.stated_pane) material.stated_pane->matt_reflectance = mean;
  if (material.texture) material.texture->texture = texture;
  if (!texture) material.texture.reset();
  return material;
}

// Removes maps into pictures that are missing or have one color.
Scene with_used_maps(Scene scene) {
  std::vector<TextureMap> maps;
  for (Polygon& polygon : scene.polygons) {
    if (polygon.texture_map == no_texture_map) continue;
    const TextureMap& map = scene.texture_maps[polygon.texture_map];
    polygon.texture_map = no_texture_map;
    if (!scene.materials[polygon.material].texture) continue;
    polygon.texture_map = static_cast<std::uint32_t>(maps.size());
    maps.push_back(map);
  }
  scene.texture_maps = std::move(maps);
  return scene;
}

// Decodes the textures of a scene that assimp read from `bytes`. Scene::inputs names the picture of each material,
// empty for none. Opaque materials with a picture have a placeholder texture, and their polygons have maps. If a
// picture cannot be read, the material loses its texture, with a note. Removes unused materials, and fills inputs and
// sha256. Pictures outside the folder `confine` (if given) are not read.
Scene with_decoded_pictures(Scene scene, const std::string& bytes, const std::filesystem::path& confine) {
  const std::vector<std::filesystem::path> names = std::exchange(scene.inputs, {});
  std::set<std::filesystem::path> files(names.begin(), names.end());
  files.erase(std::filesystem::path());
  scene.inputs.assign(files.begin(), files.end());
  const PictureColours colours = picture_colours(scene.inputs, confine, scene.file);
  std::vector<std::string> panes;
  for (std::size_t m = 0; m < names.size(); ++m) {
    if (names[m].empty()) continue;
    Material& material = scene.materials[m];
    const std::string file = names[m].string();
    const auto mean = colours.by_file.find(file);
    if (mean == colours.by_file.end()) {
      material.texture.reset();
      scene.diagnostics.push_back(
          {DiagnosticCode::unreadable_picture, "the picture " + file + " of material '" + material.name + "' " +
                                                   colours.faults.at(file) + "; it is gray instead, reflectance 0.5"});
      continue;
    }
    const auto texture = colours.textures.find(file);
    material =
        painted(std::move(material), mean->second, texture == colours.textures.end() ? nullptr : texture->second);
    if (material.stated_pane) panes.push_back(material.name);
  }
  scene.diagnostics =
      merged({std::move(scene.diagnostics), note_on(DiagnosticCode::simplified_picture,
                                                    "textures of panes are replaced by their mean color", panes)});
  std::vector<std::string> contents = {bytes};
  contents.insert(contents.end(), colours.digests.begin(), colours.digests.end());
  scene.sha256 = sha256(contents);
  return with_used_materials(with_used_maps(std::move(scene)));
}

Spectrum color(const aiMaterial& material, const char* key, double otherwise) {
  aiColor3D found;
  if (material.Get(key, 0, 0, found) != aiReturn_SUCCESS) return rgb(otherwise, otherwise, otherwise);
  return rgb(found.r, found.g, found.b);
}

// True for textures of properties other than the diffuse color.
bool has_other_texture(const aiMaterial& material) {
  for (int type = aiTextureType_DIFFUSE + 1; type <= AI_TEXTURE_TYPE_MAX; ++type) {
    if (material.GetTextureCount(static_cast<aiTextureType>(type)) > 0) return true;
  }
  return false;
}

double number_or(const aiMaterial& material, const char* key, double otherwise) {
  float found = 0;
  return material.Get(key, 0, 0, found) == aiReturn_SUCCESS ? found : otherwise;
}

// The transmittance. In COLLADA it follows from the transparent color (opaque="RGB_ZERO"); the opacity already includes
// its luminance.
Spectrum let_through(const aiMaterial& material, double opacity) {
  const Spectrum filter = color(material, "$clr.transparent", 1).max(0);
  const double luminance = 0.212671 * filter[0] + 0.715160 * filter[1] + 0.072169 * filter[2];
  if ((filter == filter[0]).all() || !(luminance > 0)) return Spectrum::Constant(3, 1 - opacity);
  return (1 - opacity) / luminance * filter;
}

// For a textured diffuse color assimp reports 1.
Material with_place_for_picture(Material material, const AssimpPicture& picture) {
  const Spectrum grey = default_material().reflectance;
  const auto value = static_cast<float>(grey[0]);
  material.reflectance = grey;
  material.texture = {std::make_shared<const Texture>(Texture{1, 1, {{value, value, value}}}),
                      primaries_times(rgb(1, 1, 1)), picture.wrap};
  return material;
}

Material assimp_material(const aiMaterial& read, const AssimpPictures& pictures, unsigned int index) {
  aiString name;
  read.Get(AI_MATKEY_NAME, name);
  // Exitance = pi radiance for a Lambertian emitter.
  Material material{name.C_Str(), color(read, "$clr.diffuse", 0.5), std::numbers::pi * color(read, "$clr.emissive", 0)};
  const auto picture = pictures.find(index);
  if (picture != pictures.end()) material = with_place_for_picture(std::move(material), picture->second);
  const double opacity = number_or(read, "$mat.opacity", 1);
  if (!(opacity >= 0 && opacity < 1)) return material;
  return as_pane(std::move(material), let_through(read, opacity),
                 plausible_index(number_or(read, "$mat.refracti", usual_index)), "opacity " + rounded(opacity));
}

bool is_used(const aiScene& model, unsigned int material) {
  for (unsigned int m = 0; m < model.mNumMeshes; ++m) {
    if (model.mMeshes[m]->mMaterialIndex == material) return true;
  }
  return false;
}

// The scene with all materials of the model, and notes on their properties that are not simulated. Textured materials
// are gray with one texel. If there are pictures, the inputs name one for each material, as with_decoded_pictures()
// expects.
Scene with_assimp_materials(Scene scene, const aiScene& model, const AssimpPictures& pictures) {
  std::vector<std::string> ignored;
  for (unsigned int m = 0; m < model.mNumMaterials; ++m) {
    const aiMaterial& read = *model.mMaterials[m];
    scene.materials.push_back(assimp_material(read, pictures, m));
    if (is_used(model, m) && has_other_texture(read)) ignored.push_back(scene.materials.back().name);
  }
  if (!pictures.empty()) scene.inputs.resize(scene.materials.size());
  for (const auto& [m, picture] : pictures) scene.inputs[m] = picture.file;
  scene.diagnostics = merged(
      {std::move(scene.diagnostics),
       note_on(DiagnosticCode::simplified_part, "textures other than those of diffuse colors are ignored", ignored)});
  return scene;
}

// Keeps only the importers of one extension: assimp would try others by file signature.
void keep_importer(Assimp::Importer& importer, const std::string& extension) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const std::string extensions = std::string(" ") + importer.GetImporterInfo(k)->mFileExtensions + " ";
    if (extensions.find(" " + extension + " ") == std::string::npos) {
      importer.UnregisterLoader(importer.GetImporter(k));
    }
  }
}

Eigen::Matrix4d matrix(const aiMatrix4x4& m) {
  Eigen::Matrix4d result;
  result << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return result;
}

// Collects the faces of all nodes.
class AssimpCollector {
 public:
  AssimpCollector(Scene scene, const aiScene& model, const AssimpPictures& pictures)
      : scene_(std::move(scene)), model_(model), pictures_(pictures), mapped_(scene_.file) {}

  void add_node(const aiNode& node, const Eigen::Matrix4d& above, const std::string& group_above) {
    const Eigen::Matrix4d to_scene = above * matrix(node.mTransformation);
    const std::string name = node.mName.C_Str();
    const std::string group = name.empty() ? group_above : name;
    for (unsigned int k = 0; k < node.mNumMeshes; ++k) add_mesh(*model_.mMeshes[node.mMeshes[k]], to_scene, group);
    for (unsigned int k = 0; k < node.mNumChildren; ++k) add_node(*node.mChildren[k], to_scene, group);
  }

  void add_lights_and_cameras() {
    for (unsigned int k = 0; k < model_.mNumLights; ++k)
      left_out_.lose("lights without a surface, which are not read from COLLADA, left out",
                     model_.mLights[k]->mName.C_Str());
    for (unsigned int k = 0; k < model_.mNumCameras; ++k)
      left_out_.lose_without_area("cameras, which are not read from COLLADA, left out",
                                  model_.mCameras[k]->mName.C_Str());
  }

  Scene scene() && {
    scene_.texture_maps = mapped_.maps();
    scene_.diagnostics = merged({std::move(scene_.diagnostics), mapped_.notes()});
    return left_out_.on(std::move(scene_));
  }

 private:
  void add_mesh(const aiMesh& mesh, const Eigen::Matrix4d& to_scene, const std::string& group) {
    const std::uint32_t index = groups_.index_of(group, scene_.groups);
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (unsigned int v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      scene_.vertices.emplace_back((to_scene * Eigen::Vector4d(p.x, p.y, p.z, 1)).head<3>());
    }
    const std::vector<Eigen::Vector2d> places = places_of(mesh);
    // A reflected copy reverses the order of its corners, so that the front stays the front.
    const bool mirrored = to_scene.topLeftCorner<3, 3>().determinant() < 0;
    for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) {
        left_out_.lose_without_area("points and lines, left out", group);
        continue;
      }
      Polygon polygon;
      for (unsigned int k = 0; k < face.mNumIndices; ++k) {
        const unsigned int corner = face.mIndices[mirrored ? face.mNumIndices - 1 - k : k];
        if (corner >= mesh.mNumVertices) throw InputError(scene_.file, "a face names a vertex that is not there");
        polygon.corners.push_back(first + corner);
      }
      polygon.material = mesh.mMaterialIndex;
      polygon.group = index;
      if (scene_.materials[polygon.material].texture)
        polygon.texture_map = mapped_.add(scene_.vertices, polygon.corners, first, places);
      scene_.polygons.push_back(std::move(polygon));
    }
  }

  std::vector<Eigen::Vector2d> places_of(const aiMesh& mesh) const {
    const auto picture = pictures_.find(mesh.mMaterialIndex);
    return picture == pictures_.end() ? std::vector<Eigen::Vector2d>() : places_in(picture->second, mesh);
  }

  Scene scene_;
  const aiScene& model_;
  const AssimpPictures& pictures_;
  MappedFaces mapped_;
  GroupIndex groups_;
  LeftOut left_out_;
};

// Reads a COLLADA model with assimp: all faces, in the order of the nodes, with the nodes' transformations. Coordinates
// have single precision, and axes stay as in the file. Diffuse colors become reflectances, emissive colors radiances in
// W/(m^2 sr), and an opacity below 1 makes a pane. Fills vertices (meters), polygons, materials, maps into pictures,
// groups (node names), file, metres_per_unit, notes and inputs for with_decoded_pictures(). May crash on damaged files:
// call it in read_isolated(). Throws InputError naming `file`.
Scene assimp_scene(const std::string& bytes, const std::string& file, double metres_per_unit) {
  Assimp::Importer importer;
  keep_importer(importer, "dae");
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* model = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "dae");
  if (model == nullptr || model->mRootNode == nullptr) {
    throw InputError(file, "is not a good dae file: " + reason_of(std::string(importer.GetErrorString())) +
                               "\nhint: export it again");
  }
  Scene scene;
  scene.file = file;
  const AssimpPictures pictures = diffuse_pictures(*model, std::filesystem::path(file).parent_path());
  scene = with_assimp_materials(std::move(scene), *model, pictures);
  Eigen::Matrix4d to_scene = Eigen::Matrix4d::Identity();
  to_scene.topLeftCorner<3, 3>() *= metres_per_unit;
  AssimpCollector collector(std::move(scene), *model, pictures);
  collector.add_node(*model->mRootNode, to_scene, "");
  collector.add_lights_and_cameras();
  scene = std::move(collector).scene();
  scene.metres_per_unit = metres_per_unit;
  return scene;
}

// The file's <up_axis>: X_UP, Y_UP (the default) or Z_UP. assimp does not report it.
Vector up_axis(const std::string& text) {
  constexpr std::string_view element = "<up_axis>";
  const std::size_t found = text.find(element);
  if (found == std::string::npos) return Vector::UnitY();
  const std::size_t value = text.find_first_not_of(" \t\r\n", found + element.size());
  if (value == std::string::npos) return Vector::UnitY();
  return text[value] == 'X' ? Vector::UnitX() : text[value] == 'Z' ? Vector::UnitZ() : Vector::UnitY();
}

// Ids of the geometries that nodes place in the scene, as "#id". Iterative, because nodes may be nested deeply.
std::set<std::string> placed_geometries(const pugi::xml_document& document) {
  struct Instances : pugi::xml_tree_walker {
    std::set<std::string> urls;
    bool for_each(pugi::xml_node& node) override {
      if (std::string_view(node.name()) == "instance_geometry") urls.insert(node.attribute("url").value());
      return true;
    }
  } instances;
  pugi::xml_node root = document.child("COLLADA");
  root.traverse(instances);
  return instances.urls;
}

// assimp skips geometries that are not meshes, and holes of polygons. Unplaced geometries are no loss.
Scene with_lost_geometry(Scene scene, const std::string& text) {
  LeftOut left_out;
  pugi::xml_document document;
  document.load_buffer(text.data(), text.size());
  const std::set<std::string> placed = placed_geometries(document);
  for (const pugi::xml_node& geometry : document.child("COLLADA").child("library_geometries").children("geometry")) {
    if (placed.count(std::string("#") + geometry.attribute("id").value()) == 0) continue;
    const std::string name = geometry.attribute(geometry.attribute("name") ? "name" : "id").value();
    const pugi::xml_node mesh = geometry.child("mesh");
    if (geometry.child("spline"))
      left_out.lose_without_area("splines, left out", name);
    else if (!mesh)
      left_out.lose("geometries that are not meshes, left out", name);
    for (const pugi::xml_node& polygons : mesh.children("polygons")) {
      for ([[maybe_unused]] const pugi::xml_node& face : polygons.children("ph"))
        left_out.lose("polygons with holes, left out; of the geometries", name);
    }
  }
  return left_out.on(std::move(scene));
}

}  // namespace

Scene read_collada(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  const std::string bytes = read_text(file, file.string(), "the model file");
  Scene scene = read_isolated(file.string(), [&] { return assimp_scene(bytes, file.string(), metres_per_unit); });
  // A separate child process decodes the pictures: if it crashes, the model keeps its colors.
  scene = with_decoded_pictures(std::move(scene), bytes, confine);
  scene = with_lost_geometry(std::move(scene), bytes);
  scene.up = up_axis(bytes);
  scene.up_stated = true;
  return scene;
}

double collada_unit(std::string_view text) {
  pugi::xml_document document;
  document.load_buffer(text.data(), text.size());
  const char* const stated = document.select_node("//asset/unit").node().attribute("meter").value();
  const double metres = finite_number(stated).value_or(1);
  return metres > 0 ? metres : 1;
}

}  // namespace patchlight
