#include "input/assimp_scene.h"

#include "patchlight/base/error.h"

#include "input/assimp_materials.h"
#include "input/assimp_pictures.h"
#include "input/left_out.h"
#include "input/texture_maps.h"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <map>
#include <utility>

namespace patchlight {
namespace {

// Leaves only the importers of one extension: assimp would try others whose signature it finds in the file.
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
    for (std::string& sentence : mapped_.notes()) scene_.notes.push_back(std::move(sentence));
    return left_out_.on(std::move(scene_));
  }

 private:
  void add_mesh(const aiMesh& mesh, const Eigen::Matrix4d& to_scene, const std::string& group) {
    const auto [entry, is_new] = groups_.emplace(group, static_cast<std::uint32_t>(scene_.groups.size()));
    if (is_new) scene_.groups.push_back(group);
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (unsigned int v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      scene_.vertices.emplace_back((to_scene * Eigen::Vector4d(p.x, p.y, p.z, 1)).head<3>());
    }
    const std::vector<Eigen::Vector2d> places = places_of(mesh);
    // A mirrored copy keeps its front where it was: the corners run the other way.
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
      polygon.group = entry->second;
      if (scene_.materials[polygon.material].texture) polygon.texture_map = mapped(polygon, first, places);
      scene_.polygons.push_back(std::move(polygon));
    }
  }

  std::vector<Eigen::Vector2d> places_of(const aiMesh& mesh) const {
    const auto picture = pictures_.find(mesh.mMaterialIndex);
    return picture == pictures_.end() ? std::vector<Eigen::Vector2d>() : places_in(picture->second, mesh);
  }

  std::uint32_t mapped(const Polygon& polygon, std::uint32_t first, const std::vector<Eigen::Vector2d>& places) {
    std::vector<Point> corners;
    std::vector<Eigen::Vector2d> in_picture;
    for (const std::uint32_t corner : polygon.corners) {
      corners.push_back(scene_.vertices[corner]);
      if (!places.empty()) in_picture.push_back(places[corner - first]);
    }
    return mapped_.add(corners, in_picture, 0);
  }

  Scene scene_;
  const aiScene& model_;
  const AssimpPictures& pictures_;
  MappedFaces mapped_;
  std::map<std::string, std::uint32_t> groups_;
  LeftOut left_out_;
};

}  // namespace

Scene assimp_scene(const std::string& bytes, const std::string& file, double metres_per_unit) {
  Assimp::Importer importer;
  keep_importer(importer, "dae");
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* model = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, "dae");
  if (model == nullptr || model->mRootNode == nullptr) {
    throw InputError(file,
                     std::string("is not a good dae file: ") + importer.GetErrorString() + "\nhint: export it again");
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

}  // namespace patchlight
