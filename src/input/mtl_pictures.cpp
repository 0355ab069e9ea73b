#include "input/mtl_pictures.h"

#include "base/rounded.h"
#include "input/materials.h"
#include "input/texture_maps.h"

#include <optional>
#include <set>
#include <utility>

namespace patchlight {
namespace {

// The mask that the picture of map_d is.
std::optional<PictureMask> mask_of(const MtlMaterial& material, const PictureColours& pictures) {
  const auto found = pictures.masks.find(material.mask_picture);
  if (found == pictures.masks.end()) return std::nullopt;
  const bool is_colour_alone = material.mask_picture == material.diffuse_texture && !found->second.colour;
  return is_colour_alone ? PictureMask{1, std::nullopt} : found->second;
}

// What d and Tr make of the covered share, and light straight through the rest: T = 1 - m + m T_d. Holes alone have no
// index of refraction. What is covered has the mean colour of map_Kd, or that of its part that is covered where its own
// alpha tells.
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

}  // namespace

PictureColours pictures_of(std::span<const MtlMaterial> materials, const std::filesystem::path& confine,
                           const std::string& model) {
  std::set<std::filesystem::path> names;
  for (const MtlMaterial& material : materials) {
    for (const std::string* const picture : {&material.diffuse_texture, &material.mask_picture})
      if (!picture->empty()) names.insert(*picture);
  }
  return picture_colours({names.begin(), names.end()}, confine, model);
}

std::vector<MtlMaterial> with_pictures(std::vector<MtlMaterial> materials, const PictureColours& pictures) {
  for (MtlMaterial& material : materials) material = with_picture(std::move(material), pictures);
  return materials;
}

std::vector<std::string> notes_on_pictures(std::span<const MtlMaterial> materials, const PictureColours& pictures) {
  std::vector<std::string> notes;
  const auto note = [&](const MtlMaterial& material, const std::string& picture, const std::string& statement,
                        const std::string& instead) {
    const auto fault = pictures.faults.find(picture);
    if (fault == pictures.faults.end()) return;
    notes.push_back("the picture " + picture + " of material '" + material.name + "' (" + statement +
                    " of its material file) " + fault->second + "; " + instead);
  };
  std::vector<std::string> covered;
  for (const MtlMaterial& material : materials) {
    note(material, material.diffuse_texture, "map_Kd, line " + std::to_string(material.texture_line),
         "Kd is used alone");
    note(material, material.mask_picture, "map_d, line " + std::to_string(material.mask_line), "it makes no holes");
    if (material.covered < 1) covered.push_back(material.name + " (" + rounded(material.covered) + ")");
  }
  for (std::string& text : note_on(covered_note, covered)) notes.push_back(std::move(text));
  return notes;
}

}  // namespace patchlight
