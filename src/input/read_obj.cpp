#include "input/read_obj.h"

#include "patchlight/base/error.h"

#include "input/read_mtl.h"
#include "input/scan_obj.h"
#include "input/sha256.h"
#include "input/text.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <sstream>
#include <tiny_obj_loader.h>

namespace patchlight {
namespace {

constexpr double default_reflectance = 0.5;
constexpr const char* default_name = "default";

// What the mtllib statements of a file bring.
struct Libraries {
  std::vector<MtlMaterial> materials;  // of those with the same name only the first counts
  std::vector<std::string> texts;      // the files' bytes, for the checksum
};

std::string at(const std::filesystem::path& file, std::uint32_t line) {
  return file.string() + ":" + std::to_string(line);
}

// The files an mtllib statement names. A name may hold spaces: when the whole statement is a file, it is the only one.
std::vector<std::filesystem::path> library_files(const std::filesystem::path& obj, const std::string& names) {
  std::error_code error;
  if (std::filesystem::exists(obj.parent_path() / names, error)) return {obj.parent_path() / names};
  std::vector<std::filesystem::path> files;
  for (const std::string_view name : words(names)) files.push_back(obj.parent_path() / name);
  return files;
}

Libraries read_libraries(const std::filesystem::path& obj, const std::vector<ObjName>& statements) {
  Libraries libraries;
  std::vector<std::filesystem::path> seen;
  for (const ObjName& statement : statements) {
    for (const std::filesystem::path& file : library_files(obj, statement.name)) {
      if (std::find(seen.begin(), seen.end(), file) != seen.end()) continue;
      seen.push_back(file);
      libraries.texts.push_back(read_text(file, at(obj, statement.line), "the material file " + file.string()));
      const std::vector<MtlMaterial> materials = read_mtl(libraries.texts.back(), file.string());
      libraries.materials.insert(libraries.materials.end(), materials.begin(), materials.end());
    }
  }
  return libraries;
}

// The index of a material among those defined; their number when there is none of that name.
std::size_t find_material(std::span<const MtlMaterial> defined, const std::string& name) {
  const auto found = std::find_if(defined.begin(), defined.end(), [&](const MtlMaterial& m) { return m.name == name; });
  return static_cast<std::size_t>(found - defined.begin());
}

// The defined materials and, unless the file defines it, the one for faces without a material.
std::vector<MtlMaterial> with_default(std::vector<MtlMaterial> defined) {
  if (find_material(defined, default_name) == defined.size()) {
    MtlMaterial material;
    material.name = default_name;
    material.reflectance = rgb(default_reflectance, default_reflectance, default_reflectance);
    material.radiance = rgb(0, 0, 0);
    material.has_reflectance = true;
    defined.push_back(material);
  }
  return defined;
}

// The defined material of every face.
std::vector<std::size_t> face_materials(const std::filesystem::path& obj, const ObjScan& scan,
                                        std::span<const MtlMaterial> defined) {
  std::vector<std::size_t> by_name;
  for (const ObjName& used : scan.materials) {
    by_name.push_back(find_material(defined, used.name));
    if (by_name.back() == defined.size()) {
      throw InputError(at(obj, used.line), "usemtl names material '" + used.name +
                                               "', which no mtllib file defines; define it there, or mend the name");
    }
  }
  const std::size_t without = find_material(defined, default_name);
  std::vector<std::size_t> materials;
  for (const ObjFace& face : scan.faces) {
    materials.push_back(face.material == no_material ? without : by_name[face.material]);
  }
  return materials;
}

// The materials that faces use, in their order of definition.
struct Palette {
  std::vector<MtlMaterial> materials;
  std::vector<MaterialIndex> of_face;
};

Palette used_materials(std::span<const MtlMaterial> defined, std::span<const std::size_t> of_face) {
  std::vector<std::uint8_t> is_used(defined.size(), 0);
  for (const std::size_t material : of_face) is_used[material] = 1;
  Palette palette;
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
                               " faces could be read; export the model anew. " + error);
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
      polygon.material = materials[face];
      polygon.group = group->second;
      polygon.line = scan.faces[face].line;
      scene.polygons.push_back(std::move(polygon));
    }
  }
  return scene;
}

std::vector<std::string> notes_on(const ObjScan& scan, const Palette& palette) {
  std::vector<std::string> notes;
  const auto note = [&](const std::string& what, std::size_t count) {
    if (count > 0) notes.push_back(what + ": " + std::to_string(count));
  };
  const auto without = std::count_if(scan.faces.begin(), scan.faces.end(),
                                     [](const ObjFace& face) { return face.material == no_material; });
  note("faces without a material, which get the material 'default' (reflectance 0.5 unless the file defines it)",
       static_cast<std::size_t>(without));
  note("lines (l), ignored", scan.polylines);
  note("points (p), ignored", scan.points);
  note("free-form surfaces (surf), ignored", scan.free_form_surfaces);
  for (std::string& sentence : notes_on_ignored(palette.materials)) notes.push_back(std::move(sentence));
  return notes;
}

}  // namespace

Scene read_obj(const std::filesystem::path& file, double metres_per_unit) {
  // 1. The text, checked.
  std::vector<std::string> bytes = {read_text(file, file.string(), "the model file")};
  const ObjScan scan = scan_obj(bytes[0], file.string());

  // 2. The materials its mtllib files define and its faces use.
  const Libraries libraries = read_libraries(file, scan.libraries);
  const std::vector<MtlMaterial> defined = with_default(libraries.materials);
  const Palette palette = used_materials(defined, face_materials(file, scan, defined));

  // 3. The scene, in metres.
  Scene scene;
  for (const Point& vertex : scan.vertices) scene.vertices.push_back(metres_per_unit * vertex);
  for (const MtlMaterial& material : palette.materials) {
    // Exitance = pi radiance for a Lambertian emitter.
    scene.materials.push_back({material.name, material.reflectance, std::numbers::pi * material.radiance});
  }
  scene = with_polygons(std::move(scene), parse_shapes(scan, file.string()), scan, palette.of_face);
  scene.file = file.string();
  scene.metres_per_unit = metres_per_unit;
  scene.notes = notes_on(scan, palette);

  // 4. The checksum of everything read.
  bytes.insert(bytes.end(), libraries.texts.begin(), libraries.texts.end());
  scene.sha256 = sha256(bytes);
  return scene;
}

}  // namespace patchlight
