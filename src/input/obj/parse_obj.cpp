#include "input/obj/parse_obj.h"

#include "patchlight/base/error.h"

#include "base/words.h"
#include "input/materials.h"
#include "input/text.h"

#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <tiny_obj_loader.h>
#include <utility>

namespace patchlight {
namespace {

// The largest vertex number in a face, checked after the whole file is read: faces may precede their vertices.
struct HighestVertex {
  std::int64_t number = 0;
  std::uint32_t line = 0;
};

std::string quoted(std::string_view word) { return std::string("'").append(word).append("'"); }

Point obj_vertex(const std::vector<std::string_view>& statement, const std::string& where) {
  if (statement.size() < 4) {
    throw InputError(where, "this vertex has " + std::to_string(statement.size() - 1) +
                                " coordinates; expected three numbers after v");
  }
  Point point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = finite_number(statement[axis + 1]);
    if (!value) {
      throw InputError(where, "the coordinate " + quoted(statement[axis + 1]) +
                                  " is not a finite number; expected three numbers after v, e.g. 1.25");
    }
    point[axis] = *value;
  }
  return point;
}

// The vertex number, from 1, of a corner, e.g. 7, 7/2, 7//3 or -1/2/3. A negative number counts back from the last
// vertex before it.
std::int64_t vertex_number(std::string_view corner, std::size_t vertices_above, const std::string& where) {
  const std::string_view digits = corner.substr(0, corner.find('/'));
  const std::int64_t number = whole_number_in<std::int64_t>(digits).value_or(0);
  if (number == 0) {
    throw InputError(where, "the corner " + quoted(corner) +
                                " names no vertex; expected a whole number other than 0, e.g. 7, 7/2 or 7//3");
  }
  if (number > 0) return number;
  const std::int64_t counted = static_cast<std::int64_t>(vertices_above) + 1 + number;
  if (counted < 1) {
    throw InputError(where, "the corner " + quoted(corner) + " counts back beyond the first of the " +
                                std::to_string(vertices_above) + " vertices above it");
  }
  return counted;
}

// The vertex numbers of a face.
std::vector<std::int64_t> face_corners(const std::vector<std::string_view>& statement, std::size_t vertices_above,
                                       const std::string& where) {
  std::vector<std::int64_t> corners;
  for (std::size_t k = 1; k < statement.size(); ++k)
    corners.push_back(vertex_number(statement[k], vertices_above, where));
  return corners;
}

// A vt statement; v is 0 if there is one number, NaN without numbers.
Eigen::Vector2d picture_point(const std::vector<std::string_view>& statement) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector2d point(unknown, unknown);
  for (std::size_t k = 0; k < 2 && k + 1 < statement.size(); ++k)
    point[static_cast<Eigen::Index>(k)] = finite_number(statement[k + 1]).value_or(unknown);
  if (statement.size() == 2) point[1] = 0;
  return point;
}

// Index, from 0, of the texture point of a corner, e.g. 7/2 or -1/-2/3; no_place if there is none.
std::uint32_t place_of(std::string_view corner, std::size_t points_above) {
  const std::size_t slash = corner.find('/');
  if (slash == std::string_view::npos) return no_place;
  const std::string_view digits = corner.substr(slash + 1, corner.find('/', slash + 1) - slash - 1);
  const std::int64_t number = whole_number_in<std::int64_t>(digits).value_or(0);
  if (number == 0) return no_place;
  const std::int64_t place = number > 0 ? number - 1 : static_cast<std::int64_t>(points_above) + number;
  return place >= 0 && place < std::int64_t{no_place} ? static_cast<std::uint32_t>(place) : no_place;
}

std::string face_statement(std::span<const std::int64_t> corners) {
  std::string statement = "f";
  for (const std::int64_t corner : corners) statement.append(" ").append(std::to_string(corner));
  return statement + "\n";
}

// Adds a face of at least three corners to the scan.
ObjScan with_face(ObjScan scan, ObjFace face, std::span<const std::int64_t> corners) {
  if (corners.size() <= 255) {  // tinyobjloader counts corners in one byte
    scan.geometry += face_statement(corners);
  } else {
    scan.geometry += face_statement(corners.first(3));
    for (const std::int64_t corner : corners) face.corners.push_back(static_cast<std::uint32_t>(corner - 1));
  }
  scan.faces.push_back(std::move(face));
  return scan;
}

void check_vertices_exist(const HighestVertex& highest, std::size_t vertices, const std::string& file) {
  if (highest.number <= static_cast<std::int64_t>(vertices)) return;
  throw InputError(at_line(file, highest.line), "this face uses vertex " + std::to_string(highest.number) +
                                                    ", but there are " + std::to_string(vertices) +
                                                    " vertices in the file; fix the index");
}

// Illumination models with refraction.
bool is_of_glass(int illumination) {
  return illumination == 4 || illumination == 6 || illumination == 7 || illumination == 9;
}

std::string shown(const Spectrum& filter) {
  return "Tf " + rounded(filter[0]) + " " + rounded(filter[1]) + " " + rounded(filter[2]);
}

MtlPane pane_with(const MtlTransparency& stated, const Spectrum& transmittance, std::string statement) {
  return {transmittance, plausible_index(stated.index.value_or(usual_index)), std::move(statement)};
}

// The transmittance by d or Tr, times Tf. A Tf of 0 is a default, which would make the material opaque, and is ignored.
MtlPane filtered(const MtlTransparency& stated, double share, const std::string& statement) {
  const bool is_coloured = stated.filter && (*stated.filter > 0).any() && (*stated.filter != 1).any();
  if (!is_coloured) return pane_with(stated, Spectrum::Constant(3, share), statement);
  return pane_with(stated, share * *stated.filter, statement + " and " + shown(*stated.filter));
}

// Illumination models with reflection but no refraction.
bool is_of_mirror(int illumination) { return illumination == 3 || illumination == 5 || illumination == 8; }

// Blender writes Ns 1000 for roughness 0, and Ns 250 for its default 0.5.
bool is_smooth(const MtlReflection& stated) {
  return (!stated.exponent || *stated.exponent >= 900) && stated.roughness <= most_roughness && !stated.has_textures;
}

// Kd and Ke of a material, and its statements on transparency and specular reflection.
struct Statements {
  std::optional<Spectrum> reflectance;
  std::optional<Spectrum> radiance;
  MtlTransparency transparency;
  MtlReflection reflection;
  std::uint32_t texture_line = 0;
  std::uint32_t mask_line = 0;
};

// A line of the file, its words, and the file name for messages.
struct MtlLine {
  const TextLine& line;
  std::vector<std::string_view> words;
  const std::string& file;
};

Spectrum numbers_after(const MtlLine& statement, std::size_t first, std::size_t count) {
  Spectrum values(static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const bool exists = first + k < statement.words.size();
    const std::optional<double> value = exists ? finite_number(statement.words[first + k]) : std::nullopt;
    if (!value) {
      throw InputError(statement.file + ":" + std::to_string(statement.line.number),
                       "found '" + std::string(trimmed(statement.line.text)) + "'; expected " +
                           (count == 1 ? "a finite number" : "three finite numbers") + " after " +
                           std::string(statement.words[0]));
    }
    values[static_cast<Eigen::Index>(k)] = *value;
  }
  return values;
}

Spectrum three_numbers(const MtlLine& statement) { return numbers_after(statement, 1, 3); }

double one_number(const MtlLine& statement) {
  const bool is_halo = statement.words.size() > 1 && statement.words[1] == "-halo";  // d -halo 0.5
  return numbers_after(statement, is_halo ? 2 : 1, 1)[0];
}

void take(Statements& material, const MtlLine& statement) {
  const std::string_view key = statement.words[0];
  if (key == "map_Kd") material.texture_line = statement.line.number;
  if (key == "map_d") material.mask_line = statement.line.number;
  if (key == "Kd") material.reflectance = three_numbers(statement);
  if (key == "Ke") material.radiance = three_numbers(statement);
  if (key == "Tf") material.transparency.filter = three_numbers(statement);
  if (key == "d") material.transparency.dissolve = one_number(statement);
  if (key == "Tr") material.transparency.transparency = one_number(statement);
  if (key == "Ni") material.transparency.index = one_number(statement);
  if (key == "Ks") material.reflection.specular = three_numbers(statement);
  if (key == "Ns") material.reflection.exponent = one_number(statement);
  if (key == "Pr") material.reflection.roughness = one_number(statement);
  if (key == "Pm") material.reflection.metallic = one_number(statement);
}

// The statements of every material. tinyobjloader turns invalid numbers into 0 and rounds others (0.75 to 0.75 +
// 1e-16). Among materials with the same name the first one is used.
std::map<std::string, Statements> read_statements(const std::vector<TextLine>& lines, const std::string& file) {
  std::map<std::string, Statements> materials;
  Statements ignored;
  Statements* current = &ignored;
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> statement = words_before_comment(line.text);
    if (statement.empty()) continue;
    if (statement[0] == "newmtl") {
      const auto [entry, is_new] = materials.try_emplace(std::string(after_first_word(line.text)));
      current = is_new ? &entry->second : &ignored;
    }
    take(*current, {line, statement, file});
  }
  return materials;
}

bool any(const tinyobj::real_t (&color)[3]) { return color[0] != 0 || color[1] != 0 || color[2] != 0; }

// The texture files of a material.
std::vector<std::string> textures_of(const tinyobj::material_t& m) {
  std::vector<std::string> textures;
  for (const std::string* texture :
       {&m.ambient_texname, &m.diffuse_texname, &m.specular_texname, &m.specular_highlight_texname, &m.bump_texname,
        &m.displacement_texname, &m.alpha_texname, &m.reflection_texname, &m.roughness_texname, &m.metallic_texname,
        &m.sheen_texname, &m.emissive_texname, &m.normal_texname}) {
    if (!texture->empty()) textures.push_back(*texture);
  }
  return textures;
}

std::optional<MtlMirror> mirror_from(const tinyobj::material_t& read, MtlReflection stated, const Spectrum& diffuse) {
  stated.diffuse = diffuse;
  stated.illumination = read.illum;
  stated.has_textures = !read.specular_texname.empty() || !read.specular_highlight_texname.empty() ||
                        !read.roughness_texname.empty() || !read.metallic_texname.empty();
  return mtl_mirror(stated);
}

// Options that select another channel (-imfchan) or change the numbers (-mm).
bool has_changed_numbers(const tinyobj::texture_option_t& options) {
  return options.imfchan != 'm' || options.brightness != 0 || options.contrast != 1;
}

MtlMaterial material_from(const tinyobj::material_t& read, const std::string& name, Statements stated) {
  stated.transparency.illumination = read.illum;
  MtlMaterial material;
  material.name = name;
  material.has_reflectance = stated.reflectance.has_value();
  material.reflectance = stated.reflectance.value_or(rgb(read.diffuse[0], read.diffuse[1], read.diffuse[2]));
  material.radiance = stated.radiance.value_or(rgb(0, 0, 0));
  material.ambient = rgb(read.ambient[0], read.ambient[1], read.ambient[2]);
  material.is_specular = any(read.specular);
  material.textures = textures_of(read);
  material.diffuse_texture = read.diffuse_texname;
  const tinyobj::texture_option_t& options = read.diffuse_texopt;
  material.texture_options = {
      {options.scale[0], options.scale[1]}, {options.origin_offset[0], options.origin_offset[1]}, options.clamp};
  material.texture_line = stated.texture_line;
  material.pane = mtl_pane(stated.transparency);
  if (!material.pane) material.mirror = mirror_from(read, stated.reflection, material.reflectance);
  material.is_contradictory = is_contradictory(stated.transparency);
  material.has_ignored_mask = !read.alpha_texname.empty() && has_changed_numbers(read.alpha_texopt);
  if (!material.has_ignored_mask) material.mask_picture = read.alpha_texname;
  material.mask_line = stated.mask_line;
  material.is_metallic = read.metallic > 0;
  material.is_mirror_or_glass = read.illum >= 3 && read.illum <= 9;
  return material;
}

bool has_ignored_mask(const MtlMaterial& material) {
  return material.has_ignored_mask || (!material.mask_picture.empty() && !material.has_mask);
}

std::vector<std::string> names_with(std::span<const MtlMaterial> materials, bool (*property)(const MtlMaterial&)) {
  std::vector<std::string> names;
  for (const MtlMaterial& material : materials) {
    if (property(material)) names.push_back(material.name);
  }
  return names;
}

}  // namespace

ObjScan scan_obj(std::string_view text, const std::string& file) {
  ObjScan scan;
  std::map<std::string, std::uint32_t, std::less<>> known;  // usemtl names
  std::uint32_t material = no_material;
  std::string object;  // or group
  HighestVertex highest;
  for (const TextLine& line : logical_lines(text)) {
    const std::vector<std::string_view> statement = words_before_comment(line.text);
    if (statement.empty()) continue;
    const std::string_view keyword = statement[0];
    if (keyword == "v") {
      scan.vertices.push_back(obj_vertex(statement, at_line(file, line.number)));
      scan.geometry += line.text + "\n";
      scan.colored_vertices += statement.size() == 7;  // x y z r g b
    } else if (keyword == "f") {
      const auto corners = face_corners(statement, scan.vertices.size(), at_line(file, line.number));
      for (const std::int64_t corner : corners) {
        if (corner > highest.number) highest = {corner, line.number};
      }
      if (corners.size() < 3) {
        scan.left_out.lose_face(too_few_corners, object, {.line = line.number});
        continue;
      }
      const std::size_t first_place = scan.places.size();
      scan = with_face(std::move(scan), {line.number, material, {}, first_place}, corners);
      for (std::size_t k = 1; k < statement.size(); ++k)
        scan.places.push_back(place_of(statement[k], scan.picture_points.size()));
    } else if (keyword == "vt") {
      scan.picture_points.push_back(picture_point(statement));
    } else if (keyword == "g" || keyword == "o") {
      object = after_first_word(line.text);
      scan.geometry += line.text + "\n";
    } else if (keyword == "usemtl") {
      const auto name = std::string(after_first_word(line.text));
      material = no_material;
      if (name.empty()) continue;
      const auto [entry, is_new] = known.emplace(name, static_cast<std::uint32_t>(scan.materials.size()));
      if (is_new) scan.materials.push_back({name, line.number});
      material = entry->second;
    } else if (keyword == "mtllib") {
      scan.libraries.push_back({std::string(after_first_word(line.text)), line.number});
    } else if (keyword == "l" || keyword == "p") {
      scan.left_out.lose_without_area(keyword == "l" ? "lines (l), left out" : "points (p), left out", object);
    } else if (keyword == "surf") {
      scan.left_out.lose("free-form surfaces (surf), left out", object);
    }
  }
  check_vertices_exist(highest, scan.vertices.size(), file);
  return scan;
}

std::optional<MtlPane> mtl_pane(const MtlTransparency& stated) {
  if (is_contradictory(stated)) return std::nullopt;
  if (stated.dissolve) {
    const double d = *stated.dissolve;
    return d >= 0 && d < 1 ? std::optional(filtered(stated, 1 - d, "d " + rounded(d))) : std::nullopt;
  }
  if (stated.transparency) {
    const double tr = *stated.transparency;
    return tr > 0 && tr <= 1 ? std::optional(filtered(stated, tr, "Tr " + rounded(tr))) : std::nullopt;
  }
  if (!is_of_glass(stated.illumination) || !stated.filter) return std::nullopt;
  if (!(*stated.filter > 0).any() || (*stated.filter >= 1).all()) return std::nullopt;
  return pane_with(stated, *stated.filter, shown(*stated.filter) + " and illum " + std::to_string(stated.illumination));
}

bool is_contradictory(const MtlTransparency& stated) {
  if (!stated.dissolve || !stated.transparency) return false;
  return (*stated.dissolve >= 1 && *stated.transparency > 0) || (*stated.dissolve <= 0 && *stated.transparency <= 0);
}

std::optional<MtlMirror> mtl_mirror(const MtlReflection& stated) {
  if (!is_of_mirror(stated.illumination) || !is_smooth(stated) || !stated.specular) return std::nullopt;
  if (!(*stated.specular > 0).any()) return std::nullopt;
  const std::string statement = "illum " + std::to_string(stated.illumination);
  if (stated.metallic >= least_metallic) {
    if (!(stated.diffuse > 0).any()) return std::nullopt;
    return MtlMirror{stated.diffuse, Spectrum::Zero(3), statement + " and Pm " + rounded(stated.metallic)};
  }
  // A diffuse reflectance of 1 leaves nothing to reflect specularly.
  if (!(stated.specular->min(1 - stated.diffuse) > 0).any()) return std::nullopt;
  return MtlMirror{*stated.specular, stated.diffuse, statement};
}

std::vector<MtlMaterial> read_mtl(const std::string& text, const std::string& file) {
  const std::vector<TextLine> lines = logical_lines(text);
  std::map<std::string, Statements> statements = read_statements(lines, file);
  std::map<std::string, int> by_name;
  std::vector<tinyobj::material_t> read;
  std::stringstream stream;
  for (const TextLine& line : lines) stream << line.text << '\n';
  tinyobj::LoadMtl(&by_name, &read, &stream, nullptr, nullptr);

  std::vector<MtlMaterial> materials;
  std::set<std::string> seen;
  for (const tinyobj::material_t& found : read) {
    const auto name = std::string(trimmed(found.name));
    if (name.empty() || !seen.insert(name).second) continue;
    materials.push_back(material_from(found, name, statements[name]));
  }
  return materials;
}

Diagnostics notes_on_ignored(std::span<const MtlMaterial> materials) {
  Diagnostics notes;
  const auto add = [&](DiagnosticCode code, const std::string& sentence, bool (*property)(const MtlMaterial&)) {
    notes = merged({std::move(notes), note_on(code, sentence, names_with(materials, property))});
  };
  const auto note = [&](const std::string& sentence, bool (*property)(const MtlMaterial&)) {
    add(DiagnosticCode::simplified_part, sentence, property);
  };
  add(DiagnosticCode::assumed_material, "no Kd, so the reflectance is 0 (0.6 with a texture)",
      [](const MtlMaterial& m) { return !m.has_reflectance; });
  note("Ks (gloss) is ignored", [](const MtlMaterial& m) { return m.is_specular && !m.mirror; });
  note("Pm (metal) is ignored, the surface is matt", [](const MtlMaterial& m) { return m.is_metallic && !m.mirror; });
  add(DiagnosticCode::simplified_picture, "map_Kd is replaced by the mean color of its picture",
      [](const MtlMaterial& m) { return m.has_mean && (!m.texture || m.pane || m.mirror); });
  note("textures are ignored, Kd is used instead",
       [](const MtlMaterial& m) { return m.textures.size() > (m.has_mean ? 1U : 0U) + (m.has_mask ? 1U : 0U); });
  note("d and Tr contradict each other, the surface is opaque",
       [](const MtlMaterial& m) { return m.is_contradictory; });
  note("map_d (transparency by a picture) is ignored", has_ignored_mask);
  note("illum 3 to 9 (mirror, glass) is ignored, the surface is matt",
       [](const MtlMaterial& m) { return m.is_mirror_or_glass && !m.pane && !m.mirror; });
  return notes;
}

std::vector<UnsimulatedMaterials> unsimulated(std::span<const MtlMaterial> materials) {
  const auto is_gloss = [](const MtlMaterial& m) {
    return !m.mirror && (m.is_specular || m.is_metallic || (m.is_mirror_or_glass && !m.pane));
  };
  const auto is_glass = [](const MtlMaterial& m) { return has_ignored_mask(m) || m.is_contradictory; };
  return counted(names_with(materials, is_gloss).size(), names_with(materials, is_glass).size());
}

}  // namespace patchlight
