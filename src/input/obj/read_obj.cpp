#include "patchlight/base/diagnostics.h"
#include "patchlight/base/error.h"

#include "base/words.h"
#include "files/sha256.h"
#include "input/materials.h"
#include "input/obj/parse_obj.h"
#include "input/picture_colours.h"
#include "input/read_model.h"
#include "input/text.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <sstream>
#include <tiny_obj_loader.h>
#include <utility>

namespace patchlight {
namespace {

// The material files of an OBJ file's mtllib statements.
struct Libraries {
  std::vector<MtlMaterial> materials;        // among those with the same name the first one is used
  std::vector<std::string> texts;            // the files' bytes, for the checksum
  std::vector<std::filesystem::path> files;  // the files and their textures
  Diagnostics problems;                      // files that are missing, or were found beside the model
};

// A file of an mtllib statement, and its path; empty if not found.
struct LibraryFile {
  std::string name;
  std::filesystem::path place;
  bool moved = false;  // found beside the model instead of at the stated path
};

bool is_file(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::is_regular_file(file, error);
}

// The files of a folder by lower-case name, the first one if several names differ only in case. Listed once, on demand.
class Folder {
 public:
  explicit Folder(std::filesystem::path place) : place_(std::move(place)) {}

  const std::filesystem::path& place() const { return place_; }
  std::optional<std::filesystem::path> similar(const std::filesystem::path& name) {
    if (!listed_) list();
    const auto found = names_.find(in_lower_case(name.string()));
    return found == names_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  void list() {
    listed_ = true;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(place_.empty() ? "." : place_, error)) {
      const std::filesystem::path name = entry.path().filename();
      const auto [found, is_new] = names_.emplace(in_lower_case(name.string()), name);
      if (!is_new && name < found->second) found->second = name;
    }
  }

  std::filesystem::path place_;
  std::map<std::string, std::filesystem::path> names_;
  bool listed_ = false;
};

// Looks at the stated path, then beside the model for the last part of the name, ignoring case. Paths may be Windows
// paths. Paths outside `confine` are refused without a look.
LibraryFile find_library(Folder& beside, const std::string& name, const std::string& where,
                         const std::filesystem::path& confine) {
  const std::filesystem::path& folder = beside.place();
  std::string slashes = name;
  std::replace(slashes.begin(), slashes.end(), '\\', '/');
  for (const std::string& path : {name, slashes}) {
    require_within(confine, folder / path, where);
    if (is_file(folder / path)) return {name, folder / path};
  }
  const std::filesystem::path last = std::filesystem::path(slashes).filename();
  if (last.empty()) return {name, {}};
  if (is_file(folder / last)) return {name, folder / last, true};
  const std::optional<std::filesystem::path> similar = beside.similar(last);
  if (!similar || !is_file(folder / *similar)) return {name, {}};
  require_within(confine, folder / *similar, where);
  return {name, folder / *similar, true};
}

// The files of an mtllib statement. Names may contain spaces: if the whole text names a file, it is the only one.
std::vector<LibraryFile> library_files(Folder& beside, const ObjName& statement, const std::string& where,
                                       const std::filesystem::path& confine) {
  const LibraryFile whole = find_library(beside, statement.name, where, confine);
  if (!whole.place.empty() && !whole.moved) return {whole};
  std::vector<LibraryFile> files;
  for (const std::string_view name : words(statement.name)) {
    files.push_back(find_library(beside, std::string(name), where, confine));
  }
  const bool all_there = std::all_of(files.begin(), files.end(), [](const auto& file) { return !file.place.empty(); });
  return all_there || whole.place.empty() ? files : std::vector{whole};
}

// The path of a texture, relative to the material file; it may be a Windows path.
std::string place_of(std::string texture, const std::filesystem::path& library) {
  std::replace(texture.begin(), texture.end(), '\\', '/');
  return texture.empty() ? texture : (library.parent_path() / texture).string();
}

// The file and the textures of its materials.
std::vector<std::filesystem::path> files_of(const std::filesystem::path& library,
                                            const std::vector<MtlMaterial>& materials) {
  std::vector<std::filesystem::path> files = {library};
  for (const MtlMaterial& material : materials) {
    for (const std::string& texture : material.textures) files.push_back(library.parent_path() / texture);
  }
  return files;
}

std::optional<Diagnostic> problem_with(const LibraryFile& file, const std::string& where) {
  const std::string found = "mtllib (" + where + ") names '" + file.name + "', ";
  if (file.place.empty()) {
    return Diagnostic{DiagnosticCode::missing_material_file,
                      found +
                          "which is neither there nor beside the model; materials that no other file defines "
                          "are gray, reflectance 0.5"};
  }
  if (!file.moved) return std::nullopt;
  return Diagnostic{DiagnosticCode::moved_material_file,
                    found + "which is not there; " + file.place.string() + " is taken instead"};
}

// Reads the files of the mtllib statements. A file missing at its path is searched beside the model, by the last part
// of its name, ignoring case. Throws InputError when a file cannot be read, or lies outside the folder `confine` (if
// given).
Libraries read_libraries(const std::filesystem::path& obj, const std::vector<ObjName>& statements,
                         const std::filesystem::path& confine) {
  Libraries libraries;
  Folder beside(obj.parent_path());
  std::set<std::string> names;
  std::set<std::filesystem::path> places;
  for (const ObjName& statement : statements) {
    const std::string where = at_line(obj, statement.line);
    for (const LibraryFile& file : library_files(beside, statement, where, confine)) {
      if (!names.insert(file.name).second) continue;
      const std::optional<Diagnostic> problem = problem_with(file, where);
      if (problem) libraries.problems.push_back(*problem);
      if (file.place.empty() || !places.insert(file.place).second) continue;
      libraries.texts.push_back(read_text(file.place, where, "the material file " + file.place.string()));
      std::vector<MtlMaterial> materials = read_mtl(libraries.texts.back(), file.place.string());
      const std::vector<std::filesystem::path> named = files_of(file.place, materials);
      libraries.files.insert(libraries.files.end(), named.begin(), named.end());
      for (MtlMaterial& material : materials) {
        material.diffuse_texture = place_of(material.diffuse_texture, file.place);
        material.mask_picture = place_of(material.mask_picture, file.place);
      }
      libraries.materials.insert(libraries.materials.end(), materials.begin(), materials.end());
    }
  }
  return libraries;
}

// The mask of the picture of map_d.
std::optional<PictureMask> mask_of(const MtlMaterial& material, const PictureColours& pictures) {
  const auto found = pictures.masks.find(material.mask_picture);
  if (found == pictures.masks.end()) return std::nullopt;
  const bool is_colour_alone = material.mask_picture == material.diffuse_texture && !found->second.colour;
  return is_colour_alone ? PictureMask{1, std::nullopt} : found->second;
}

// Combines the pane of d and Tr in the covered part m with the open rest: T = 1 - m + m T_d. Holes alone have index 1.
// The reflectance is the mean color of map_Kd, or of its covered part if the mask is its own alpha.
MtlMaterial with_holes(MtlMaterial material, const PictureMask& mask, const Spectrum& factor) {
  const double m = mask.covered;
  const std::string statement = "map_d covers " + rounded(m);
  MtlPane pane{Spectrum::Constant(3, 1 - m), 1, statement};
  if (material.pane) {
    pane.transmittance += m * material.pane->transmittance;
    pane.index = material.pane->index;
    pane.statement = material.pane->statement + " and " + statement;
  }
  const bool is_own = material.mask_picture == material.diffuse_texture;
  pane.reflectance = m * (is_own && mask.colour ? Spectrum(factor * *mask.colour) : material.reflectance);
  material.pane = std::move(pane);
  material.mirror.reset();
  material.covered = m;
  return material;
}

// Applies map_Kd and map_d. The reflectance is the mean color of map_Kd times Kd, unless Kd is 0: exporters write 0
// beside a texture. If both maps name the same picture, its alpha is the mask; without alpha it has no holes.
MtlMaterial with_picture(MtlMaterial material, const PictureColours& pictures) {
  const bool has_factor = material.has_reflectance && (material.reflectance > 0).any();
  const Spectrum factor = has_factor ? material.reflectance : rgb(1, 1, 1);
  const auto mean = pictures.by_file.find(material.diffuse_texture);
  if (mean != pictures.by_file.end()) {
    material.reflectance = factor * mean->second;
    material.has_mean = true;
  }
  const auto texture = pictures.textures.find(material.diffuse_texture);
  if (texture != pictures.textures.end()) {
    const Wrap wrap = material.texture_options.clamp ? Wrap::clamp : Wrap::repeat;
    material.texture = {texture->second, primaries_times(factor), {wrap, wrap}};
  }
  const std::optional<PictureMask> mask = mask_of(material, pictures);
  material.has_mask = mask.has_value();
  return mask && mask->covered < 1 ? with_holes(std::move(material), *mask, factor) : material;
}

// The pictures of map_Kd and map_d. `model` is the file that names the material files.
PictureColours pictures_of(std::span<const MtlMaterial> materials, const std::filesystem::path& confine,
                           const std::string& model) {
  std::set<std::filesystem::path> names;
  for (const MtlMaterial& material : materials) {
    for (const std::string* const picture : {&material.diffuse_texture, &material.mask_picture})
      if (!picture->empty()) names.insert(*picture);
  }
  return picture_colours({names.begin(), names.end()}, confine, model);
}

// A note for each map_Kd and map_d that cannot be read, and one on masks with holes.
Diagnostics notes_on_pictures(std::span<const MtlMaterial> materials, const PictureColours& pictures) {
  Diagnostics notes;
  const auto note = [&](const MtlMaterial& material, const std::string& picture, const std::string& statement,
                        const std::string& instead) {
    const auto fault = pictures.faults.find(picture);
    if (fault == pictures.faults.end()) return;
    notes.push_back({DiagnosticCode::unreadable_picture, "the picture " + picture + " of material '" + material.name +
                                                             "' (" + statement + " of its material file) " +
                                                             fault->second + "; " + instead});
  };
  std::vector<std::string> covered;
  for (const MtlMaterial& material : materials) {
    note(material, material.diffuse_texture, "map_Kd, line " + std::to_string(material.texture_line),
         "Kd is used alone");
    note(material, material.mask_picture, "map_d, line " + std::to_string(material.mask_line), "it makes no holes");
    if (material.covered < 1) covered.push_back(material.name + " (" + rounded(material.covered) + ")");
  }
  return merged({std::move(notes), note_on(DiagnosticCode::cut_out_material, covered_note, covered)});
}

constexpr const char* default_name = "default";

// Indices of materials by name; the first one of a name is used.
using IndexByName = std::map<std::string, std::size_t>;

IndexByName index_by_name(std::span<const MtlMaterial> defined) {
  IndexByName index;
  for (std::size_t m = 0; m < defined.size(); ++m) index.emplace(defined[m].name, m);
  return index;
}

MtlMaterial grey_material(const std::string& name) {
  MtlMaterial material;
  material.name = name;
  material.reflectance = default_material().reflectance;
  material.radiance = material.ambient = rgb(0, 0, 0);
  material.has_reflectance = true;
  return material;
}

// Materials for names in usemtl without a definition, and for faces before any usemtl.
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

// The used materials, in order of definition.
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

// Adds polygons and groups. Shapes hold the faces in file order: the k-th face of the shapes is the k-th of the scan.
Scene with_polygons(Scene scene, std::span<const tinyobj::shape_t> shapes, const ObjScan& scan,
                    std::span<const MaterialIndex> materials) {
  GroupIndex groups;
  for (const tinyobj::shape_t& shape : shapes) {
    const std::uint32_t group = groups.index_of(shape.name, scene.groups);
    auto corner = shape.mesh.indices.begin();
    for (const unsigned char count : shape.mesh.num_face_vertices) {
      const std::size_t face = scene.polygons.size();
      Polygon polygon;
      for (int k = 0; k < count; ++k) polygon.corners.push_back(static_cast<std::uint32_t>((corner++)->vertex_index));
      if (!scan.faces[face].corners.empty()) polygon.corners = scan.faces[face].corners;
      polygon.material = materials[face];
      polygon.group = group;
      polygon.line = scan.faces[face].line;
      scene.polygons.push_back(std::move(polygon));
    }
  }
  return scene;
}

// Texture coordinates of the corners of a face, with v from the top and -s and -o applied.
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

// Adds the textures of the palette to the polygons, which are the faces in scan order.
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
  scene.diagnostics = merged({std::move(scene.diagnostics), mapped.notes()});
  return scene;
}

Diagnostics notes_on(const ObjScan& scan, const ObjPalette& palette) {
  Diagnostics notes;
  if (scan.colored_vertices > 0)
    notes.push_back(
        {DiagnosticCode::simplified_part, "colors of vertices, ignored: " + std::to_string(scan.colored_vertices)});
  return merged({std::move(notes), notes_on_ignored(palette.materials)});
}

Diagnostics problems_with_names(const std::string& file, const ObjScan& scan, std::span<const MtlMaterial> defined) {
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
  Diagnostics problems;
  if (!unknown.empty()) {
    problems.push_back({DiagnosticCode::unknown_material,
                        "usemtl names " + first_few(unknown, 5) +
                            ", which no material file defines; such materials are gray, reflectance 0.5",
                        unknown.size()});
  }
  Diagnostic without{DiagnosticCode::no_material};
  for (std::size_t k = 0; k < scan.faces.size(); ++k) {
    if (scan.faces[k].material != no_material) continue;
    without.faces.push_back({{}, 0, scan.faces[k].line, static_cast<std::uint32_t>(k)});
  }
  without.count = without.faces.size();
  without.text = "faces without a material, as there is no usemtl above them: " + std::to_string(without.count) +
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
  // Covered part only.
  material.reflectance = *read.pane->reflectance;
  material.stated_pane->matt_exitance = material.exitance;
  material.exitance *= read.covered;
  return material;
}

// Materials without emission but with Ka above 1: some programs mean lamps.
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
  for (MtlMaterial& material : palette.materials) material = with_picture(std::move(material), pictures);

  // 3. The scene, in meters.
  Scene scene;
  for (const Point& vertex : scan.vertices) scene.vertices.push_back(metres_per_unit * vertex);
  for (const MtlMaterial& material : palette.materials) scene.materials.push_back(obj_material(material));
  scene = with_polygons(std::move(scene), parse_shapes(scan, file.string()), scan, palette.of_face);
  scene.file = file.string();
  scene.metres_per_unit = metres_per_unit;
  scene.unsimulated = unsimulated(palette.materials);
  scene.diagnostics = merged({libraries.problems, problems_with_names(file.string(), scan, libraries.materials),
                              notes_on(scan, palette), notes_on_pictures(palette.materials, pictures)});
  scene = with_texture_maps(std::move(scene), scan, palette);
  scene.lamp_hints = lamp_hints(palette.materials);
  scene.inputs = libraries.files;
  scene = scan.left_out.on(std::move(scene));

  // 4. The checksum of everything read.
  bytes.insert(bytes.end(), libraries.texts.begin(), libraries.texts.end());
  bytes.insert(bytes.end(), pictures.digests.begin(), pictures.digests.end());
  scene.sha256 = sha256(bytes);
  return scene;
}

}  // namespace patchlight
