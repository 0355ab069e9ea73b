#include "input/read_mtl.h"

#include "patchlight/base/error.h"

#include "input/text.h"

#include <map>
#include <set>
#include <sstream>
#include <tiny_obj_loader.h>

namespace patchlight {
namespace {

// Checks Kd and Ke, which tinyobjloader would quietly turn into 0, and returns the names of the materials with a Kd.
std::set<std::string> materials_with_reflectance(const std::string& text, const std::string& file) {
  std::set<std::string> names;
  std::string name;
  for (const TextLine& line : logical_lines(text)) {
    const std::vector<std::string_view> statement = words_before_comment(line.text);
    if (statement.empty()) continue;
    if (statement[0] == "newmtl") name = after_first_word(line.text);
    if (statement[0] != "Kd" && statement[0] != "Ke") continue;
    bool good = statement.size() >= 4;
    for (std::size_t k = 1; good && k <= 3; ++k) good = finite_number(statement[k]).has_value();
    if (!good) {
      throw InputError(file + ":" + std::to_string(line.number), "found '" + std::string(trimmed(line.text)) +
                                                                     "'; expected three finite numbers after " +
                                                                     std::string(statement[0]));
    }
    if (statement[0] == "Kd") names.insert(name);
  }
  return names;
}

bool any(const tinyobj::real_t (&color)[3]) { return color[0] != 0 || color[1] != 0 || color[2] != 0; }

bool has_texture(const tinyobj::material_t& m) {
  for (const std::string* texture :
       {&m.ambient_texname, &m.diffuse_texname, &m.specular_texname, &m.specular_highlight_texname, &m.bump_texname,
        &m.displacement_texname, &m.alpha_texname, &m.reflection_texname, &m.roughness_texname, &m.metallic_texname,
        &m.sheen_texname, &m.emissive_texname, &m.normal_texname}) {
    if (!texture->empty()) return true;
  }
  return false;
}

MtlMaterial material_from(const tinyobj::material_t& read, const std::string& name) {
  MtlMaterial material;
  material.name = name;
  material.reflectance = rgb(read.diffuse[0], read.diffuse[1], read.diffuse[2]);
  material.radiance = rgb(read.emission[0], read.emission[1], read.emission[2]);
  material.is_specular = any(read.specular);
  material.has_texture = has_texture(read);
  material.is_transparent = read.dissolve < 1;
  material.is_mirror_or_glass = read.illum >= 3 && read.illum <= 9;
  material.has_ambient = any(read.ambient);
  return material;
}

std::vector<std::string> names_with(std::span<const MtlMaterial> materials, bool (*property)(const MtlMaterial&)) {
  std::vector<std::string> names;
  for (const MtlMaterial& material : materials) {
    if (property(material)) names.push_back(material.name);
  }
  return names;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::string& text, const std::string& file) {
  const std::set<std::string> with_reflectance = materials_with_reflectance(text, file);
  std::map<std::string, int> by_name;
  std::vector<tinyobj::material_t> read;
  std::istringstream stream(text);
  tinyobj::LoadMtl(&by_name, &read, &stream, nullptr, nullptr);

  std::vector<MtlMaterial> materials;
  std::set<std::string> seen;
  for (const tinyobj::material_t& found : read) {
    const auto name = std::string(trimmed(found.name));
    if (name.empty() || !seen.insert(name).second) continue;
    materials.push_back(material_from(found, name));
    materials.back().has_reflectance = with_reflectance.contains(name);
  }
  return materials;
}

std::vector<std::string> notes_on_ignored(std::span<const MtlMaterial> materials) {
  std::vector<std::string> notes;
  const auto note = [&](const std::string& sentence, bool (*property)(const MtlMaterial&)) {
    const std::vector<std::string> names = names_with(materials, property);
    if (!names.empty()) notes.push_back(sentence + ": " + listed(names));
  };
  note("no Kd, so the reflectance is 0 (0.6 with a texture)", [](const MtlMaterial& m) { return !m.has_reflectance; });
  note("Ks (gloss) is ignored", [](const MtlMaterial& m) { return m.is_specular; });
  note("textures are ignored, Kd is used instead", [](const MtlMaterial& m) { return m.has_texture; });
  note("d and Tr (transparency) are ignored, the surface is opaque",
       [](const MtlMaterial& m) { return m.is_transparent; });
  note("illum 3 to 9 (mirror, glass) is ignored, the surface is matt",
       [](const MtlMaterial& m) { return m.is_mirror_or_glass; });
  if (names_with(materials, [](const MtlMaterial& m) { return (m.radiance > 0).any(); }).empty()) {
    note("no material has a Ke, so nothing emits; Ka is ignored, but may be meant as a lamp's Ke",
         [](const MtlMaterial& m) { return m.has_ambient; });
  }
  return notes;
}

}  // namespace patchlight
