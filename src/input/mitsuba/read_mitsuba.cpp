#include "patchlight/base/error.h"
#include "patchlight/light/material.h"
#include "patchlight/scene/scene.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/left_out.h"
#include "input/materials.h"
#include "input/mitsuba/mitsuba_file.h"
#include "input/read_model.h"
#include "input/round_shapes.h"
#include "input/text.h"
#include "scene/model_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

namespace patchlight {
namespace {

// Meshes from files, each read once.
struct MitsubaMeshes {
  std::filesystem::path confine;  // the folder that must contain them; empty: no restriction
  std::map<std::string, std::optional<FacetedShape>> by_file;
  std::vector<std::filesystem::path> files;  // files that were read
  std::vector<std::string> digests;          // their digests
  Diagnostics losses;                        // parts that were left out
};

// The supported kinds of shapes.
constexpr std::array kinds_of_shapes = {"obj", "ply", "rectangle", "cube", "sphere", "disk", "cylinder"};

// From -1 to 1 in x and y; the front faces +z.
FacetedShape rectangle() { return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2, 3}}}; }

// From -1 to 1, fronts outward.
FacetedShape cube() {
  FacetedShape shape;
  for (const double z : {-1., 1.})
    for (const double y : {-1., 1.})
      for (const double x : {-1., 1.}) shape.points.emplace_back(x, y, z);
  shape.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return shape;
}

FacetedShape faces_of(Scene scene) {
  FacetedShape shape;
  shape.points = std::move(scene.vertices);
  for (Polygon& polygon : scene.polygons) shape.faces.push_back(std::move(polygon.corners));
  return shape;
}

std::optional<FacetedShape> mesh_of(const MitsubaFile& file, const pugi::xml_node& shape, const std::string& kind,
                                    MitsubaMeshes& meshes) {
  const std::string place = file.place(shape);
  const std::string name = file.word(shape, "filename", "");
  if (name.empty()) throw InputError(place, "the shape has no filename; expected the name of a mesh");
  const std::filesystem::path path = std::filesystem::path(file.files()[0]->file).parent_path() / name;
  require_within(meshes.confine, path, place);
  const auto [found, is_new] = meshes.by_file.try_emplace(path.lexically_normal().string());
  std::error_code error;
  if (!is_new || !std::filesystem::is_regular_file(path, error)) return found->second;
  Scene scene = kind == "obj" ? read_obj(path, 1, meshes.confine) : read_ply(path, 1);
  meshes.files.push_back(path);
  meshes.digests.push_back(scene.sha256);
  for (const Diagnostic& problem : scene.diagnostics) {
    if (is_loss(problem.code)) meshes.losses.push_back(problem);
  }
  found->second = faces_of(std::move(scene));
  return found->second;
}

FacetedShape cylinder_of(const MitsubaFile& file, const pugi::xml_node& shape) {
  return faceted_cone(file.vector(shape, "p0", Vector(0, 0, 0)), file.vector(shape, "p1", Vector(0, 0, 1)),
                      file.number(shape, "radius", 1), file.number(shape, "radius", 1));
}

// The faces of a shape before its transformation. Empty if the file of a mesh is missing. Throws InputError naming the
// line, or the mesh's file.
std::optional<FacetedShape> mitsuba_shape(const MitsubaFile& file, const pugi::xml_node& shape, MitsubaMeshes& meshes) {
  const std::string kind = file.text(shape, "type");
  if (kind == "obj" || kind == "ply") return mesh_of(file, shape, kind, meshes);
  if (kind == "rectangle") return rectangle();
  if (kind == "cube") return cube();
  if (kind == "disk") return faceted_ring(Point::Zero(), Vector::UnitZ(), 0, 1);
  if (kind == "cylinder" || kind == "sphere") {
    const double radius = file.number(shape, "radius", 1);
    if (!(radius > 0))
      throw InputError(file.place(shape), "the " + kind + " has a radius of 0 or less; expected one above 0");
    const FacetedShape found = kind == "sphere" ? faceted_sphere(file.vector(shape, "center", Vector::Zero()), radius)
                                                : cylinder_of(file, shape);
    if (found.faces.empty()) throw InputError(file.place(shape), "the cylinder has no length; expected two places");
    return found;
  }
  return std::nullopt;
}

// The material of a Mitsuba BSDF.
struct MitsubaMaterial {
  Material material;
  bool is_nothing = false;              // light passes unchanged
  std::vector<std::string> simplified;  // simplifications, for notes
};

// BSDFs that wrap another one without changing diffuse light.
constexpr std::array wrappers = {"twosided", "bumpmap", "bump",         "normalmap", "mask",
                                 "opacity",  "coating", "roughcoating", "blendbsdf", "mixturebsdf"};
// Properties that may define the reflectance; the first one found is used.
constexpr std::array color_names = {"reflectance", "diffusereflectance", "basecolor", "specularreflectance"};
constexpr std::array glass_kinds = {"dielectric", "thindielectric", "roughdielectric"};
constexpr std::array conductors = {"conductor", "roughconductor"};

template <std::size_t N>
bool is_one_of(const std::array<const char*, N>& kinds, const std::string& kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

// Index of refraction, a number or the name of a medium.
double index_in(const MitsubaFile& file, const pugi::xml_node& bsdf, const std::string& name, double otherwise) {
  static const std::map<std::string, double> known = {
      {"vacuum", 1},     {"air", 1.000277}, {"ice", 1.31},           {"water", 1.333},        {"bk7", 1.5046},
      {"quartz", 1.458}, {"pyrex", 1.470},  {"acrylic glass", 1.49}, {"polypropylene", 1.49}, {"diamond", 2.419}};
  const pugi::xml_node property = file.property(bsdf, name);
  if (!property) return otherwise;
  const std::string stated = file.text(property, "value");
  const auto found = known.find(stated);
  if (found != known.end()) return found->second;
  const std::optional<double> number = finite_number(stated);
  if (number && *number > 0) return *number;
  throw InputError(file.place(property),
                   "found '" + stated + "' where an index of refraction is expected, e.g. 1.5 or bk7");
}

// Normal incidence on a conductor, Fresnel: ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2).
Spectrum fresnel(const Spectrum& eta, const Spectrum& k) {
  return ((eta - 1).square() + k.square()) / ((eta + 1).square() + k.square());
}

// Reads the material of a BSDF. Diffuse BSDFs and diffuse parts are kept. Dielectrics become panes, smooth conductors
// mirrors, and other glossy surfaces matt. Wrappers are skipped. An empty node is a surface without a BSDF. Throws
// InputError naming the line.
class MaterialReader {
 public:
  MaterialReader(const MitsubaFile& file, const std::string& name) : file_(file) {
    read_.material = {name, rgb(0, 0, 0), rgb(0, 0, 0)};
  }

  MitsubaMaterial of(const pugi::xml_node& bsdf, int depth) && {
    add(bsdf, depth);
    return std::move(read_);
  }

 private:
  void simplify(const std::string& what) { read_.simplified.push_back(what); }

  void add(const pugi::xml_node& bsdf, int depth) {
    const std::string kind = file_.text(bsdf, "type");
    if (!bsdf) {
      simplify("surfaces without a BSDF have the reflectance 0.5");
      read_.material.reflectance = rgb(0.5, 0.5, 0.5);
    } else if (is_one_of(wrappers, kind)) {
      if (static_cast<std::size_t>(depth) == reading_limits::nesting)
        throw InputError(file_.place(bsdf), "BSDFs are nested more than 64 deep");
      if (kind != "twosided") simplify(kind + " is ignored; the BSDF inside it is used");
      add(file_.nested(bsdf, "bsdf"), depth + 1);
    } else if (is_one_of(glass_kinds, kind)) {
      add_glass(bsdf, kind);
    } else if (is_one_of(conductors, kind)) {
      add_conductor(bsdf, kind);
    } else if (kind == "difftrans") {
      read_.material.diffuse_transmittance = colour(bsdf, "transmittance").value_or(rgb(0.5, 0.5, 0.5));
    } else if (kind == "null") {
      read_.is_nothing = true;
      simplify("null is nothing: such surfaces are left out");
    } else {
      add_matt(bsdf, kind);
    }
  }

  std::optional<Spectrum> colour(const pugi::xml_node& bsdf, const std::string& name) {
    const pugi::xml_node property = file_.property(bsdf, name);
    const std::optional<MitsubaColour> found = mitsuba_colour(file_, property);
    if (!found) return std::nullopt;
    if (!found->simplified.empty()) simplify(found->simplified);
    return found->value;
  }

  void add_matt(const pugi::xml_node& bsdf, const std::string& kind) {
    std::optional<Spectrum> found;
    for (const char* const name : color_names) {
      if (!found) found = colour(bsdf, name);
    }
    const bool is_matt = kind == "diffuse" || kind == "lambertian";
    if (!is_matt) simplify(kind + (found ? " becomes matt" : " has no known reflectance; 0.5 is used"));
    read_.material.reflectance = found.value_or(rgb(0.5, 0.5, 0.5)).min(1).max(0);
  }

  // A pane of that index without absorption, or with a color.
  void add_glass(const pugi::xml_node& bsdf, const std::string& kind) {
    const double inside = index_in(file_, bsdf, "intior", 1.5046);
    const double outside = index_in(file_, bsdf, "extior", 1.000277);
    const double index = plausible_index(std::max(inside / outside, outside / inside));
    const Spectrum share = colour(bsdf, "speculartransmittance").value_or(rgb(1, 1, 1)) * highest_transmittance(index);
    if (kind == "dielectric") simplify("dielectric surfaces are thin clear panes, which do not bend light");
    if (kind == "roughdielectric") simplify("roughdielectric lets light straight through, without scattering it");
    read_.material = as_pane(std::move(read_.material), share, index, kind);
  }

  // Reflectance at normal incidence; by name if there are no optical constants.
  Spectrum metal_reflectance(const pugi::xml_node& bsdf) {
    static const std::map<std::string, Spectrum> known = {{"none", rgb(1, 1, 1)},        {"Ag", rgb(0.97, 0.96, 0.92)},
                                                          {"Al", rgb(0.91, 0.92, 0.92)}, {"Au", rgb(1, 0.77, 0.34)},
                                                          {"Cu", rgb(0.95, 0.64, 0.54)}, {"Cr", rgb(0.55, 0.56, 0.55)},
                                                          {"Ni", rgb(0.66, 0.61, 0.53)}};
    const std::optional<Spectrum> eta = colour(bsdf, "eta");
    const std::optional<Spectrum> k = colour(bsdf, "k");
    if (eta && k) return fresnel(*eta / index_in(file_, bsdf, "exteta", 1), *k / index_in(file_, bsdf, "exteta", 1));
    const auto found = known.find(file_.word(bsdf, "material", "Cu"));
    if (found != known.end()) return found->second;
    simplify("a metal that is not known by name reflects 0.9");
    return rgb(0.9, 0.9, 0.9);
  }

  void add_conductor(const pugi::xml_node& bsdf, const std::string& kind) {
    const Spectrum reflected =
        (colour(bsdf, "specularreflectance").value_or(rgb(1, 1, 1)) * metal_reflectance(bsdf)).min(1).max(0);
    if (kind == "conductor") {
      read_.material.reflectance = reflected;
      read_.material = as_mirror(std::move(read_.material), reflected, rgb(0, 0, 0), kind);
      return;
    }
    simplify(kind + " becomes matt");
    read_.material.reflectance = reflected;
  }

  const MitsubaFile& file_;
  MitsubaMaterial read_;
};

Spectrum strength(const MitsubaFile& file, const pugi::xml_node& emitter, const std::string& name) {
  const std::optional<MitsubaColour> found = mitsuba_colour(file, file.property(emitter, name));
  return (found ? found->value : rgb(1, 1, 1)) * file.number(emitter, "scale", 1);
}

Vector turned(const Eigen::Matrix4d& matrix, const Vector& direction) {
  return (matrix.topLeftCorner<3, 3>() * direction).stableNormalized();
}

Point placed_at(const Eigen::Matrix4d& matrix, const Point& point) { return (matrix * point.homogeneous()).head<3>(); }

// Named by the id, else `otherwise`.
Luminaire luminaire_of(const MitsubaFile& file, const pugi::xml_node& emitter, const char* otherwise) {
  Luminaire luminaire;
  const std::string id = file.text(emitter, "id");
  luminaire.name = id.empty() ? otherwise : id;
  luminaire.place = file.place(emitter);
  return luminaire;
}

Scene with_point(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  Luminaire luminaire = luminaire_of(file, emitter, "point light");
  luminaire.position =
      scene.metres_per_unit * placed_at(file.to_world(emitter), file.vector(emitter, "position", Vector::Zero()));
  luminaire.light = PointLight{strength(file, emitter, "intensity") * std::pow(scene.metres_per_unit, 2)};
  scene.luminaires.push_back(std::move(luminaire));
  return scene;
}

// The intensity equals that on the axis up to the beam width and falls linearly to 0 at the cutoff angle. The spot
// profile here has the same half width. Its field angle gives the same flux within 7 %.
Scene with_spot(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  const double cutoff = file.number(emitter, "cutoffangle", 20);
  const double beam = file.number(emitter, "beamwidth", 0.75 * cutoff);
  if (!(0 <= beam && beam < cutoff && cutoff <= 90))
    throw InputError(file.place(emitter), "found a spot with a beam width of " + rounded(beam) +
                                              " and a cutoff angle of " + rounded(cutoff) +
                                              " degrees; expected 0 <= beam width < cutoff angle <= 90");
  Luminaire luminaire = luminaire_of(file, emitter, "spot light");
  const Eigen::Matrix4d matrix = file.to_world(emitter);
  luminaire.position = scene.metres_per_unit * placed_at(matrix, Point::Zero());
  luminaire.aim = turned(matrix, Vector::UnitZ());
  if (!(luminaire.aim.norm() > 0.5)) throw InputError(file.place(emitter), "the spot emitter has no direction");
  luminaire.zero_plane = luminaire.aim.unitOrthogonal();
  // A linear fall reaches one half in the middle, and one tenth at 90 % of the range.
  luminaire.light = SpotLight{strength(file, emitter, "intensity") * std::pow(scene.metres_per_unit, 2),
                              beam + 0.5 * (cutoff - beam), beam + 0.9 * (cutoff - beam)};
  scene.luminaires.push_back(std::move(luminaire));
  return scene;
}

Scene with_directional(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  const Vector stated = file.vector(emitter, "direction", Vector::UnitZ());
  const Vector way = turned(file.to_world(emitter), stated);
  if (!(way.norm() > 0.5)) throw InputError(file.place(emitter), "the directional emitter has no direction");
  scene.sun = Sun{-way, strength(file, emitter, "irradiance")};
  return scene;
}

// Adds an emitter that is not a surface: a constant environment becomes a uniform sky and ground, a point light a
// luminaire, a directional light the sun. Notes list other emitters, with advice for skies. Throws InputError naming
// the line.
Scene with_mitsuba_emitter(Scene scene, const MitsubaFile& file, const pugi::xml_node& emitter) {
  const std::string kind = file.text(emitter, "type");
  if (kind == "point") return with_point(std::move(scene), file, emitter);
  if (kind == "spot") return with_spot(std::move(scene), file, emitter);
  if (kind == "directional" && !scene.sun) return with_directional(std::move(scene), file, emitter);
  if (kind == "constant" && !scene.sky) {
    const Spectrum radiance = strength(file, emitter, "radiance");
    scene.sky = Sky{.zenith_radiance = radiance, .ground_radiance = radiance};
    return scene;
  }
  const bool is_sky = kind == "envmap" || kind == "sky" || kind == "sunsky" || kind == "sun" || kind == "constant";
  const char* const remedy =
      is_sky ? ": give the scene a sky by --sky, e.g. --sky overcast:10000lx, a sun by --sun" : "";
  scene.diagnostics.push_back(
      {DiagnosticCode::left_out, "the emitter " + kind + " (" + file.place(emitter) + ") is left out" + remedy});
  return scene;
}

// Adds the view of a perspective sensor.
Scene with_mitsuba_sensor(Scene scene, const MitsubaFile& file, const pugi::xml_node& sensor) {
  if (file.text(sensor, "type") != "perspective" && file.text(sensor, "type") != "thinlens") return scene;
  const Eigen::Matrix4d matrix = file.to_world(sensor);
  const Point eye = scene.metres_per_unit * placed_at(matrix, Point::Zero());
  const Vector way = turned(matrix, Vector::UnitZ());
  const pugi::xml_node film = file.nested(sensor, "film");
  const double aspect = file.number(film, "height", 576) / file.number(film, "width", 768);
  const double stated = std::tan(file.number(sensor, "fov", 50) * std::numbers::pi / 360);
  // The angle is horizontal unless fovAxis differs.
  const std::string axis = file.word(sensor, "fovaxis", "x");
  const bool is_vertical = axis == "y" || (axis == "smaller" && aspect < 1) || (axis == "larger" && aspect > 1);
  const double angle = 360 / std::numbers::pi * std::atan(is_vertical ? stated : stated * aspect);
  if (!(way.norm() > 0.5) || !(angle > 0 && angle < 180)) return scene;
  const std::string id = file.text(sensor, "id");
  scene.cameras.push_back({eye, eye + way, angle, id.empty() ? "sensor" : id});
  return scene;
}

// The radiance of a shape's area emitter; black without one. Throws InputError naming the line.
Spectrum emitted_radiance(const MitsubaFile& file, const pugi::xml_node& shape) {
  pugi::xml_node emitter = file.nested(shape, "emitter");
  if (!emitter) emitter = file.nested(shape, "luminaire");
  if (!emitter || file.text(emitter, "type") != "area") return rgb(0, 0, 0);
  return strength(file, emitter, "radiance");
}

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
    scene_.diagnostics = merged({std::move(scene_.diagnostics), meshes_.losses});
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
    if (kind == "shapegroup") return;  // placed by instances
    if (kind == "instance") return add_instance(shape, above, depth);
    if (!is_one_of(kinds_of_shapes, kind))
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
    // A reflected copy keeps its front.
    const bool is_turned = file_.flag(shape, "flipnormals") != (to_scene.topLeftCorner<3, 3>().determinant() < 0);
    const auto placed = [&](const Point& point) { return placed_at(to_scene, point); };
    Polygon polygon{.corners = {}, .material = material, .group = group, .line = file_.line(shape)};
    scene_ = with_shape(std::move(scene_), faces, placed, is_turned, std::move(polygon));
  }

  // Empty for surfaces that light passes unchanged.
  std::optional<MaterialIndex> material_of(const pugi::xml_node& shape, const std::string& name) {
    const pugi::xml_node bsdf = file_.nested(shape, "bsdf");
    const Spectrum radiance = emitted_radiance(file_, shape);
    const std::string id = id_of(bsdf);
    const auto key =
        std::tuple(bsdf.hash_value(), id.empty() ? name : id, std::array{radiance[0], radiance[1], radiance[2]});
    const auto [found, is_new] = index_.emplace(key, std::nullopt);
    if (!is_new) return found->second;
    MitsubaMaterial read = MaterialReader(file_, id.empty() ? name : id).of(bsdf, 0);
    const bool emits = (radiance > 0).any();
    // A lamp without a BSDF, or with a null BSDF, reflects nothing.
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

  // The id of the BSDF, or of the one that it wraps.
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
