#include "input/read_obj.h"

#include "patchlight/base/error.h"

#include "files/sha256.h"
#include "input/at_line.h"
#include "input/mtl_pictures.h"
#include "input/obj_libraries.h"
#include "input/read_mtl.h"
#include "input/scan_obj.h"
#include "input/stated_mirrors.h"
#include "input/stated_panes.h"
#include "input/text.h"
#include "input/texture_maps.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <sstream>
#include <tiny_obj_loader.h>
#include <utility>

namespace patchlight {
namespace {

constexpr double default_reflectance = 0.5;
constexpr const char* default_name = "default";

// Indices of materials by name; the first one of a name counts.
using IndexByName = std::map<std::string, std::size_t>;

IndexByName index_by_name(std::span<const MtlMaterial> defined) {
  IndexByName index;
  for (std::size_t m = 0; m < defined.size(); ++m) index.emplace(defined[m].name, m);
  return index;
}

MtlMaterial grey_material(const std::string& name) {
  MtlMaterial material;
  material.name = name;
  material.reflectance = rgb(default_reflectance, default_reflectance, default_reflectance);
  material.radiance = rgb(0, 0, 0);
  material.ambient = rgb(0, 0, 0);
  material.has_reflectance = true;
  return material;
}

// The materials of the names that usemtl statements use and no file defines, and the one for faces before any usemtl.
std::vector<MtlMaterial> undefined_materials(const ObjScan& scan, std::span<const MtlMaterial> defined) {
  std::vector<MtlMaterial> undefined;
  IndexByName known = index_by_name(defined);
  const auto add = [&](const std::string& name) {
    if (known.emplace(name, known.size()).second) undefined.push_back(grey_material(name));
  };
  for (const ObjName& used : scan.materials) add(used.name);
  add(default_name);
  return undefined;
}

// The defined material of every face.
std::vector<std::size_t> face_materials(const ObjScan& scan, std::span<const MtlMaterial> defined) {
  const IndexByName index = index_by_name(defined);
  std::vector<std::size_t> by_name;
  for (const ObjName& used : scan.materials) by_name.push_back(index.at(used.name));
  const std::size_t without = index.at(default_name);
  std::vector<std::size_t> materials;
  for (const ObjFace& face : scan.faces) {
    materials.push_back(face.material == no_material ? without : by_name[face.material]);
  }
  return materials;
}

// The materials that faces use, in their order of definition.
struct ObjPalette {
  std::vector<MtlMaterial> materials;
  std::vector<MaterialIndex> of_face;
};

ObjPalette used_materials(std::span<const MtlMaterial> defined, std::span<const std::size_t> of_face) {
  std::vector<std::uint8_t> is_used(defined.size(), 0);
  for (const std::size_t material : of_face) is_used[material] = 1;
  ObjPalette palette;
  std::vector<MaterialIndex> number(defined.size(), 0);
  for (std::size_t m = 0; m < defined.size(); ++m) {
    if (!is_used[m]) continue;
    number[m] = static_cast<MaterialIndex>(palette.materials.size());
    palette.materials.push_back(defined[m]);
  }
  for (const std::size_t material : of_face) palette.of_face.push_back(number[material]);
  return palette;
}

std::vector<tinyobj::shape_t> parse_shapes(const ObjScan& scan, const std::string& file) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warning;
  std::string error;
  std::istringstream stream(scan.geometry);
  const bool good =
      tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream, nullptr, false, false);
  std::size_t faces = 0;
  for (const tinyobj::shape_t& shape : shapes) faces += shape.mesh.num_face_vertices.size();
  if (!good || faces != scan.faces.size()) {
    throw InputError(file, "only " + std::to_string(faces) + " of " + std::to_string(scan.faces.size()) +
                               " faces could be read: " + error + "\nhint: export the model again");
  }
  return shapes;
}

// The scene with polygons and groups added. Shapes hold the faces in the file's order, so the k-th face read is the
// k-th face scanned.
Scene with_polygons(Scene scene, std::span<const tinyobj::shape_t> shapes, const ObjScan& scan,
                    std::span<const MaterialIndex> materials) {
  std::map<std::string, std::uint32_t> groups;
  for (const tinyobj::shape_t& shape : shapes) {
    const auto [group, is_new] = groups.emplace(shape.name, static_cast<std::uint32_t>(scene.groups.size()));
    if (is_new) scene.groups.push_back(shape.name);
    auto corner = shape.mesh.indices.begin();
    for (const unsigned char count : shape.mesh.num_face_vertices) {
      const std::size_t face = scene.polygons.size();
      Polygon polygon;
      for (int k = 0; k < count; ++k) polygon.corners.push_back(static_cast<std::uint32_t>((corner++)->vertex_index));
      if (!scan.faces[face].corners.empty()) polygon.corners = scan.faces[face].corners;
      polygon.material = materials[face];
      polygon.group = group->second;
      polygon.line = scan.faces[face].line;
      scene.polygons.push_back(std::move(polygon));
    }
  }
  return scene;
}

// The corners of a face in the picture of its material: v from the top, as -s and -o have it.
std::vector<Eigen::Vector2d> picture_places(const ObjScan& scan, const ObjFace& face, std::size_t corners,
                                            const TextureOptions& options) {
  std::vector<Eigen::Vector2d> places;
  for (std::size_t k = face.first_place; k < face.first_place + corners; ++k) {
    if (scan.places[k] >= scan.picture_points.size()) return {};
    const Eigen::Vector2d point = scan.picture_points[scan.places[k]].cwiseProduct(options.scale) + options.offset;
    places.emplace_back(point.x(), 1 - point.y());
  }
  return places;
}

// The scene with the pictures of the palette on its polygons, which are the faces in the scan's order.
Scene with_texture_maps(Scene scene, const ObjScan& scan, const ObjPalette& palette) {
  MappedFaces mapped(scene.file);
  for (std::size_t f = 0; f < scene.polygons.size(); ++f) {
    Polygon& polygon = scene.polygons[f];
    if (!scene.materials[polygon.material].texture) continue;
    const std::vector<Eigen::Vector2d> places = picture_places(scan, scan.faces[f], polygon.corners.size(),
                                                               palette.materials[polygon.material].texture_options);
    polygon.texture_map = mapped.add(corner_points(scene, static_cast<PolygonIndex>(f)), places, polygon.line);
  }
  scene.texture_maps = mapped.maps();
  for (std::string& note : mapped.notes()) scene.notes.push_back(std::move(note));
  return scene;
}

std::vector<std::string> notes_on(const ObjScan& scan, const ObjPalette& palette) {
  std::vector<std::string> notes;
  const auto note = [&](const std::string& what, std::size_t count) {
    if (count > 0) notes.push_back(what + ": " + std::to_string(count));
  };
  note("colours of vertices, ignored", scan.colored_vertices);
  for (std::string& sentence : notes_on_ignored(palette.materials)) notes.push_back(std::move(sentence));
  return notes;
}

// "a (room.obj:3), b (room.obj:9) and 12 more".
std::string first_few(const std::vector<std::string>& texts) {
  constexpr std::size_t few = 5;
  const std::size_t count = std::min(few, texts.size());
  const std::string rest = texts.size() > few ? " and " + std::to_string(texts.size() - few) + " more" : "";
  return listed(std::span(texts).first(count)) + rest;
}

std::vector<Problem> problems_with_names(const std::string& file, const ObjScan& scan,
                                         std::span<const MtlMaterial> defined) {
  std::vector<std::uint8_t> has_face(scan.materials.size(), 0);
  for (const ObjFace& face : scan.faces) {
    if (face.material != no_material) has_face[face.material] = 1;
  }
  const IndexByName index = index_by_name(defined);
  std::vector<std::string> unknown;
  for (std::size_t m = 0; m < scan.materials.size(); ++m) {
    const ObjName& used = scan.materials[m];
    if (has_face[m] && index.count(used.name) == 0 && used.name != default_name) {
      unknown.push_back("'" + used.name + "' (" + at_line(file, used.line) + ")");
    }
  }
  std::vector<Problem> problems;
  if (!unknown.empty()) {
    problems.push_back({ProblemKind::unknown_material,
                        unknown.size(),
                        "usemtl names " + first_few(unknown) +
                            ", which no material file defines; such materials are grey, reflectance 0.5",
                        {}});
  }
  Problem without{ProblemKind::no_material, 0, {}, {}};
  for (std::size_t k = 0; k < scan.faces.size(); ++k) {
    if (scan.faces[k].material != no_material) continue;
    without.faces.push_back({{}, 0, scan.faces[k].line, static_cast<std::uint32_t>(k)});
  }
  without.count = without.faces.size();
  without.what = "faces without a material, as there is no usemtl above them: " + std::to_string(without.count) +
                 "; they get the material 'default', reflectance 0.5 unless a material file defines it";
  if (without.count > 0) problems.push_back(std::move(without));
  return problems;
}

Material obj_material(const MtlMaterial& read) {
  // Exitance = pi radiance for a Lambertian emitter.
  Material material{read.name, read.reflectance, std::numbers::pi * read.radiance};
  material.texture = read.texture;
  if (read.mirror)
    return as_mirror(std::move(material), read.mirror->specular_reflectance, read.mirror->reflectance,
                     read.mirror->statement);
  if (!read.pane) return material;
  material = as_pane(std::move(material), read.pane->transmittance, read.pane->index, read.pane->statement);
  if (!read.pane->reflectance) return material;
  // There in part.
  material.reflectance = *read.pane->reflectance;
  material.stated_pane->matt_exitance = material.exitance;
  material.exitance *= read.covered;
  return material;
}

// Materials that do not emit, but have a Ka above 1: some programs mean a lamp by that.
std::vector<LampHint> lamp_hints(std::span<const MtlMaterial> materials) {
  std::vector<LampHint> hints;
  for (const MtlMaterial& material : materials) {
    if ((material.radiance > 0).any() || !(material.ambient > 1).any()) continue;
    std::ostringstream reason;
    reason << "its Ka is " << material.ambient.format(Eigen::IOFormat(6, Eigen::DontAlignCols, ", "));
    hints.push_back({material.name, material.ambient, reason.str()});
  }
  return hints;
}

}  // namespace

Scene read_obj(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine) {
  // 1. The text, checked.
  std::vector<std::string> bytes = {read_text(file, file.string(), "the model file")};
  const ObjScan scan = scan_obj(bytes[0], file.string());

  // 2. The materials its mtllib files define and its faces use.
  const Libraries libraries = read_libraries(file, scan.libraries, confine);
  std::vector<MtlMaterial> defined = libraries.materials;
  const std::vector<MtlMaterial> undefined = undefined_materials(scan, defined);
  defined.insert(defined.end(), undefined.begin(), undefined.end());
  ObjPalette palette = used_materials(defined, face_materials(scan, defined));
  const PictureColours pictures = pictures_of(palette.materials, confine, file.string());
  palette.materials = with_pictures(std::move(palette.materials), pictures);

  // 3. The scene, in metres.
  Scene scene;
  for (const Point& vertex : scan.vertices) scene.vertices.push_back(metres_per_unit * vertex);
  for (const MtlMaterial& material : palette.materials) scene.materials.push_back(obj_material(material));
  scene = with_polygons(std::move(scene), parse_shapes(scan, file.string()), scan, palette.of_face);
  scene.file = file.string();
  scene.metres_per_unit = metres_per_unit;
  scene.notes = notes_on(scan, palette);
  scene.unsimulated = unsimulated(palette.materials);
  for (std::string& note : notes_on_pictures(palette.materials, pictures)) scene.notes.push_back(std::move(note));
  scene = with_texture_maps(std::move(scene), scan, palette);
  scene.lamp_hints = lamp_hints(palette.materials);
  scene.inputs = libraries.files;
  scene.problems = libraries.problems;
  for (Problem& problem : problems_with_names(file.string(), scan, libraries.materials)) {
    scene.problems.push_back(std::move(problem));
  }
  scene = scan.left_out.on(std::move(scene));

  // 4. The checksum of everything read.
  bytes.insert(bytes.end(), libraries.texts.begin(), libraries.texts.end());
  bytes.insert(bytes.end(), pictures.digests.begin(), pictures.digests.end());
  scene.sha256 = sha256(bytes);
  return scene;
}

}  // namespace patchlight
