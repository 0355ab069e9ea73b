#include "input/read_mtl.h"

#include "patchlight/base/error.h"

#include "input/materials.h"
#include "input/text.h"

#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <tiny_obj_loader.h>

namespace patchlight {
namespace {

// Kd and Ke of one material.
struct Colors {
  std::optional<Spectrum> reflectance;
  std::optional<Spectrum> radiance;
};

Spectrum three_numbers(const TextLine& line, const std::vector<std::string_view>& statement, const std::string& file) {
  Spectrum values(3);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::optional<double> value = k + 1 < statement.size() ? finite_number(statement[k + 1]) : std::nullopt;
    if (!value) {
      throw InputError(file + ":" + std::to_string(line.number), "found '" + std::string(trimmed(line.text)) +
                                                                     "'; expected three finite numbers after " +
                                                                     std::string(statement[0]));
    }
    values[static_cast<Eigen::Index>(k)] = *value;
  }
  return values;
}

// Kd and Ke of every material, read here because tinyobjloader turns what it cannot read into 0 and rounds the rest
// (0.75 to 0.75 + 1e-16). Of materials with the same name the first counts.
std::map<std::string, Colors> read_colors(const std::vector<TextLine>& lines, const std::string& file) {
  std::map<std::string, Colors> colors;
  Colors ignored;
  Colors* current = &ignored;
  for (const TextLine& line : lines) {
    const std::vector<std::string_view> statement = words_before_comment(line.text);
    if (statement.empty()) continue;
    if (statement[0] == "newmtl") {
      const auto [entry, is_new] = colors.try_emplace(std::string(after_first_word(line.text)));
      current = is_new ? &entry->second : &ignored;
    }
    if (statement[0] == "Kd") current->reflectance = three_numbers(line, statement, file);
    if (statement[0] == "Ke") current->radiance = three_numbers(line, statement, file);
  }
  return colors;
}

bool any(const tinyobj::real_t (&color)[3]) { return color[0] != 0 || color[1] != 0 || color[2] != 0; }

// The files of textures that a material names.
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

MtlMaterial material_from(const tinyobj::material_t& read, const std::string& name, const Colors& colors) {
  MtlMaterial material;
  material.name = name;
  material.has_reflectance = colors.reflectance.has_value();
  material.reflectance = colors.reflectance.value_or(rgb(read.diffuse[0], read.diffuse[1], read.diffuse[2]));
  material.radiance = colors.radiance.value_or(rgb(0, 0, 0));
  material.ambient = rgb(read.ambient[0], read.ambient[1], read.ambient[2]);
  material.is_specular = any(read.specular);
  material.textures = textures_of(read);
  material.is_transparent = read.dissolve < 1;
  material.is_metallic = read.metallic > 0;
  material.is_mirror_or_glass = read.illum >= 3 && read.illum <= 9;
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
  const std::vector<TextLine> lines = logical_lines(text);
  std::map<std::string, Colors> colors = read_colors(lines, file);
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
    materials.push_back(material_from(found, name, colors[name]));
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
  note("Pm (metal) is ignored, the surface is matt", [](const MtlMaterial& m) { return m.is_metallic; });
  note("textures are ignored, Kd is used instead", [](const MtlMaterial& m) { return !m.textures.empty(); });
  note("d and Tr (transparency) are ignored, the surface is opaque",
       [](const MtlMaterial& m) { return m.is_transparent; });
  note("illum 3 to 9 (mirror, glass) is ignored, the surface is matt",
       [](const MtlMaterial& m) { return m.is_mirror_or_glass; });
  return notes;
}

std::vector<UnsimulatedMaterials> unsimulated(std::span<const MtlMaterial> materials) {
  const auto is_mirror = [](const MtlMaterial& m) {
    return m.is_specular || m.is_metallic || (m.is_mirror_or_glass && !m.is_transparent);
  };
  const auto is_glass = [](const MtlMaterial& m) { return m.is_transparent; };
  return counted(names_with(materials, is_mirror).size(), names_with(materials, is_glass).size());
}

}  // namespace patchlight
