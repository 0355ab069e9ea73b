#include "input/assimp_scene.h"

#include "patchlight/base/error.h"

#include "input/assimp_materials.h"
#include "input/assimp_pictures.h"
#include "input/texture_maps.h"

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>
#include <map>
#include <set>
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

// Names that assimp makes up for the IFC relations between two objects.
bool is_made_up(const std::string& name) { return name.starts_with("$Rel") || name.starts_with("IfcMappedItem"); }

using Seam = std::array<std::array<float, 3>, 2>;

std::array<float, 3> coordinates(const aiVector3D& p) { return {p.x, p.y, p.z}; }

Seam between(const aiVector3D& a, const aiVector3D& b) {
  Seam seam = {coordinates(a), coordinates(b)};
  if (seam[1] < seam[0]) std::swap(seam[0], seam[1]);
  return seam;
}

const aiVector3D& corner_of(const aiMesh& mesh, const aiFace& face, unsigned int k) {
  return mesh.mVertices[std::min(face.mIndices[k % face.mNumIndices], mesh.mNumVertices - 1)];
}

// The seams that faces walk both ways to a hole in them.
std::set<Seam> seams_of(const aiMesh& mesh) {
  constexpr unsigned int fewest_corners = 8;  // of two triangles and the ends of a seam
  std::set<Seam> seams;
  for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < fewest_corners) continue;
    std::set<Seam> edges;
    for (unsigned int k = 0; k < face.mNumIndices; ++k) {
      const Seam edge = between(corner_of(mesh, face, k), corner_of(mesh, face, k + 1));
      if (!edges.insert(edge).second) seams.insert(edge);
    }
  }
  return seams;
}

// An extruded profile has a pair of walls along each seam, which are no faces of the solid.
bool stands_on_seam(const aiMesh& mesh, const aiFace& face, const std::set<Seam>& seams) {
  if (seams.empty() || face.mNumIndices != 4) return false;
  for (unsigned int k = 0; k < 4; ++k) {
    if (seams.contains(between(corner_of(mesh, face, k), corner_of(mesh, face, k + 1)))) return true;
  }
  return false;
}

constexpr const char* space_class = "IfcSpace_";
constexpr const char* storey_class = "IfcBuildingStorey_";

// "A102" of "IfcSpace_A102_0BTBFw6f90Nfh9rP1dlXr2", which ends in the object's identifier of 22 letters.
std::string inner_name(const std::string& name) {
  constexpr std::size_t identifier = 23;  // with its underscore
  const std::size_t begin = name.find('_') + 1;
  const std::size_t end = name.size() > begin + identifier ? name.size() - identifier : name.size();
  return name.substr(begin, end - begin);
}

// Collects the faces of all nodes.
class AssimpCollector {
 public:
  AssimpCollector(Scene scene, const aiScene& model, const AssimpPictures& pictures, bool has_seams)
      : scene_(std::move(scene)), model_(model), pictures_(pictures), mapped_(scene_.file), has_seams_(has_seams) {}

  void add_node(const aiNode& node, const Eigen::Matrix4d& above, const std::string& group_above,
                const std::string& storey_above) {
    const Eigen::Matrix4d to_scene = above * matrix(node.mTransformation);
    const std::string name = node.mName.C_Str();
    const std::string group = name.empty() || is_made_up(name) ? group_above : name;
    const std::string storey = name.starts_with(storey_class) ? inner_name(name) : storey_above;
    for (unsigned int k = 0; k < node.mNumMeshes; ++k) {
      const aiMesh& mesh = *model_.mMeshes[node.mMeshes[k]];
      if (group.starts_with(space_class)) {
        add_to_room(mesh, to_scene, group, storey);
      } else {
        add_mesh(mesh, to_scene, group);
      }
    }
    for (unsigned int k = 0; k < node.mNumChildren; ++k) add_node(*node.mChildren[k], to_scene, group, storey);
  }

  Scene scene() && {
    if (other_primitives_ > 0) {
      scene_.notes.push_back("points and lines, ignored: " + std::to_string(other_primitives_));
    }
    scene_.texture_maps = mapped_.maps();
    for (std::string& sentence : mapped_.notes()) scene_.notes.push_back(std::move(sentence));
    return std::move(scene_);
  }

 private:
  // A space is air: its body tells where a room is.
  void add_to_room(const aiMesh& mesh, const Eigen::Matrix4d& to_scene, const std::string& space,
                   const std::string& storey) {
    if (scene_.rooms.empty() || last_space_ != space) scene_.rooms.push_back({inner_name(space), storey, {}});
    last_space_ = space;
    for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
      std::vector<Point>& corners = scene_.rooms.back().faces.emplace_back();
      for (unsigned int k = 0; k < mesh.mFaces[f].mNumIndices; ++k) {
        const aiVector3D& p = corner_of(mesh, mesh.mFaces[f], k);
        corners.emplace_back((to_scene * Eigen::Vector4d(p.x, p.y, p.z, 1)).head<3>());
      }
    }
  }

  void add_mesh(const aiMesh& mesh, const Eigen::Matrix4d& to_scene, const std::string& group) {
    const auto [entry, is_new] = groups_.emplace(group, static_cast<std::uint32_t>(scene_.groups.size()));
    if (is_new) scene_.groups.push_back(group);
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (unsigned int v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      scene_.vertices.emplace_back((to_scene * Eigen::Vector4d(p.x, p.y, p.z, 1)).head<3>());
    }
    const std::vector<Eigen::Vector2d> places = places_of(mesh);
    const std::set<Seam> seams = has_seams_ ? seams_of(mesh) : std::set<Seam>();
    // A mirrored copy keeps its front where it was: the corners run the other way.
    const bool mirrored = to_scene.topLeftCorner<3, 3>().determinant() < 0;
    for (unsigned int f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) {
        ++other_primitives_;
        continue;
      }
      if (stands_on_seam(mesh, face, seams)) continue;
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
  bool has_seams_;
  std::string last_space_;  // with its identifier
  std::map<std::string, std::uint32_t> groups_;
  std::size_t other_primitives_ = 0;
};

}  // namespace

Scene assimp_scene(const std::string& bytes, const std::string& file, const AssimpFormat& format,
                   double metres_per_unit) {
  Assimp::Importer importer;
  keep_importer(importer, format.extension);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_IFC_SKIP_SPACE_REPRESENTATIONS, false);
  const aiScene* model = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, format.extension.c_str());
  if (model == nullptr || model->mRootNode == nullptr) {
    throw InputError(file, std::string("is not a good ") + format.extension + " file: " + importer.GetErrorString() +
                               "; export it anew");
  }
  Scene scene;
  scene.file = file;
  AssimpPictures pictures;
  if (format.has_pictures) pictures = diffuse_pictures(*model, std::filesystem::path(file).parent_path());
  scene = with_assimp_materials(std::move(scene), *model, pictures);
  Eigen::Matrix4d to_scene = Eigen::Matrix4d::Identity();
  to_scene.topLeftCorner<3, 3>() = metres_per_unit * format.turn;
  AssimpCollector collector(std::move(scene), *model, pictures, format.has_seams);
  collector.add_node(*model->mRootNode, to_scene, "", "");
  scene = std::move(collector).scene();
  scene.metres_per_unit = metres_per_unit;
  return scene;
}

}  // namespace patchlight
