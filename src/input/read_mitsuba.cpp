#include "input/read_mitsuba.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/mitsuba_emitters.h"
#include "input/mitsuba_material.h"
#include "input/mitsuba_shape.h"
#include "input/reading_limits.h"
#include "input/unique_names.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace patchlight {
namespace {

class MitsubaReader {
 public:
  MitsubaReader(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine)
      : file_(file, confine) {
    meshes_.confine = confine;
    scene_.file = file.string();
    scene_.metres_per_unit = metres_per_unit;
  }

  Scene scene() && {
    Eigen::Matrix4d in_metres = Eigen::Matrix4d::Identity();
    in_metres.topLeftCorner<3, 3>() *= scene_.metres_per_unit;
    for (const pugi::xml_node& element : file_.elements()) {
      const std::string_view kind = element.name();
      if (kind == "shape") add_shape(element, in_metres, 0);
      if (kind == "emitter" || kind == "luminaire") scene_ = with_mitsuba_emitter(std::move(scene_), file_, element);
      if (kind == "sensor" || kind == "camera") scene_ = with_mitsuba_sensor(std::move(scene_), file_, element);
    }
    std::vector<std::string> digests;
    for (const auto& xml : file_.files()) {
      digests.push_back(sha256({&xml->bytes, 1}));
      if (digests.size() > 1) scene_.inputs.emplace_back(xml->file);
    }
    const PictureColours& pictures = file_.pictures();
    for (const auto& [name, colour] : pictures.by_file) scene_.inputs.emplace_back(name);
    digests.insert(digests.end(), pictures.digests.begin(), pictures.digests.end());
    digests.insert(digests.end(), meshes_.digests.begin(), meshes_.digests.end());
    scene_.inputs.insert(scene_.inputs.end(), meshes_.files.begin(), meshes_.files.end());
    scene_.sha256 = sha256(digests);
    scene_ = left_out_.on(std::move(scene_));
    scene_.problems.insert(scene_.problems.end(), meshes_.losses.begin(), meshes_.losses.end());
    return with_used_materials(std::move(scene_));
  }

 private:
  static std::string stem(const std::string& name) { return std::filesystem::path(name).stem().string(); }

  // Its id, the name of its mesh, or its kind.
  std::string name_of(const pugi::xml_node& shape) const {
    std::string id = file_.text(shape, "id");
    if (!id.empty()) return id;
    const std::string mesh = stem(file_.word(shape, "filename", ""));
    return mesh.empty() ? file_.text(shape, "type") : mesh;
  }

  void add_shape(const pugi::xml_node& shape, const Eigen::Matrix4d& above, int depth) {
    const std::string kind = file_.text(shape, "type");
    const std::string name = name_of(shape);
    if (kind == "shapegroup") return;  // stands where instances say
    if (kind == "instance") return add_instance(shape, above, depth);
    if (!is_mitsuba_shape(kind))
      return left_out_.lose("shapes that cannot be read are left out, of the kind " + kind, name);
    const std::optional<FacetedShape> faces = mitsuba_shape(file_, shape, meshes_);
    if (!faces) return left_out_.lose("meshes that are not there, left out", file_.word(shape, "filename", ""));
    const std::optional<MaterialIndex> material = material_of(shape, name);
    if (!material) return;
    if (kind == "sphere" || kind == "disk" || kind == "cylinder")
      left_out_.add(
          "round surfaces have " + std::to_string(round_sides) + " sides, moved outward so that areas are kept", name);
    add_faces(shape, *faces, above * file_.to_world(shape), *material, free_group(name));
  }

  void add_instance(const pugi::xml_node& instance, const Eigen::Matrix4d& above, int depth) {
    const pugi::xml_node group = file_.nested(instance, "shape");
    if (static_cast<std::size_t>(depth) == reading_limits::nesting)
      throw InputError(file_.place(instance), "instances stand in each other more than 64 deep; expected fewer levels");
    for (const pugi::xml_node& shape : group.children("shape")) {
      if (++copies_ > reading_limits::copies)
        throw InputError(file_.place(instance), "instances hold more than 1,000,000 shapes; expected fewer");
      add_shape(shape, above * file_.to_world(instance), depth + 1);
    }
  }

  void add_faces(const pugi::xml_node& shape, const FacetedShape& faces, const Eigen::Matrix4d& to_scene,
                 MaterialIndex material, std::uint32_t group) {
    if (scene_.polygons.size() + faces.faces.size() > reading_limits::polygons)
      throw InputError(file_.place(shape), "there are more than 10,000,000 faces, counting instances; expected fewer");
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    for (const Point& point : faces.points) scene_.vertices.emplace_back((to_scene * point.homogeneous()).head<3>());
    // A mirrored copy keeps its front.
    const bool is_turned = file_.flag(shape, "flipnormals") != (to_scene.topLeftCorner<3, 3>().determinant() < 0);
    const std::uint32_t line = file_.line(shape);
    for (std::vector<std::uint32_t> corners : faces.faces) {
      for (std::uint32_t& corner : corners) corner += first;
      if (is_turned) std::reverse(corners.begin(), corners.end());
      scene_.polygons.push_back({.corners = std::move(corners), .material = material, .group = group, .line = line});
    }
  }

  // Nothing for surfaces that light passes as if they were not there.
  std::optional<MaterialIndex> material_of(const pugi::xml_node& shape, const std::string& name) {
    const pugi::xml_node bsdf = file_.nested(shape, "bsdf");
    const Spectrum radiance = emitted_radiance(file_, shape);
    const std::string id = id_of(bsdf);
    const auto key =
        std::tuple(bsdf.hash_value(), id.empty() ? name : id, std::array{radiance[0], radiance[1], radiance[2]});
    const auto [found, is_new] = index_.emplace(key, std::nullopt);
    if (!is_new) return found->second;
    MitsubaMaterial read = mitsuba_material(file_, bsdf, id.empty() ? name : id);
    const bool emits = (radiance > 0).any();
    // A lamp without a BSDF, or whose surface is not there for other light, reflects nothing.
    if (emits && (!bsdf || read.is_nothing)) {
      read.material.reflectance = rgb(0, 0, 0);
      read.simplified.clear();
      read.is_nothing = false;
    }
    for (const std::string& what : read.simplified) left_out_.add(what, read.material.name);
    if (read.is_nothing) return std::nullopt;
    read.material.exitance = std::numbers::pi * radiance;  // E = pi L
    found->second = static_cast<MaterialIndex>(scene_.materials.size());
    scene_.materials.push_back(std::move(read.material));
    return found->second;
  }

  // Its own, or that of what it is put around.
  std::string id_of(const pugi::xml_node& bsdf) const {
    const std::string id = file_.text(bsdf, "id");
    return id.empty() && bsdf.child("bsdf") ? file_.text(bsdf.child("bsdf"), "id") : id;
  }

  std::uint32_t free_group(const std::string& name) {
    scene_.groups.push_back(group_names_.unique(name));
    return static_cast<std::uint32_t>(scene_.groups.size() - 1);
  }

  MitsubaFile file_;
  MitsubaMeshes meshes_;
  Scene scene_;
  LeftOut left_out_;
  UniqueNames group_names_;
  std::size_t copies_ = 0;  // shapes visited within instances
  std::map<std::tuple<std::size_t, std::string, std::array<double, 3>>, std::optional<MaterialIndex>> index_;
};

}  // namespace

Scene read_mitsuba(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  return MitsubaReader(file, metres_per_unit, confine).scene();
}

}  // namespace patchlight
