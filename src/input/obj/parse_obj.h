#pragma once

#include "patchlight/base/geometry.h"
#include "patchlight/light/material.h"
#include "patchlight/light/spectrum.h"
#include "patchlight/scene/scene.h"

#include "input/left_out.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

/// A name in an OBJ file and the line it stands on.
struct ObjName {
  std::string name;
  std::uint32_t line = 0;
};

/// Stands for a face before any usemtl.
inline constexpr std::uint32_t no_material = ~std::uint32_t{0};

/// Stands for a corner that names no picture point, or none that is there.
inline constexpr std::uint32_t no_place = ~std::uint32_t{0};

/// The facts of a face from its line and those above it.
struct ObjFace {
  std::uint32_t line = 0;
  std::uint32_t material = no_material;  ///< index into ObjScan::materials
  std::vector<std::uint32_t> corners;    ///< from 0, when there are more than tinyobjloader can count; else empty
  std::size_t first_place = 0;           ///< index into ObjScan::places of its first corner
};

/// An OBJ file whose numbers and indices are known to be good.
struct ObjScan {
  std::vector<Point> vertices;                  ///< in model units
  std::vector<ObjFace> faces;                   ///< in the file's order
  std::vector<Eigen::Vector2d> picture_points;  ///< the vt statements, v from the bottom
  std::vector<std::uint32_t> places;            ///< per corner of each face: a picture point, or no_place
  std::vector<ObjName> materials;               ///< the names after usemtl, each once
  std::vector<ObjName> libraries;               ///< what follows each mtllib
  std::string geometry;  ///< the v, f, g and o statements alone, one per line; faces with vertices only, and
                         ///< with the first three alone where ObjFace::corners has them all
  LeftOut left_out;      ///< faces with fewer than 3 corners, lines, points and free-form surfaces
  std::size_t colored_vertices = 0;  ///< v statements with a color after the coordinates
};

/// Checks the statements of an OBJ file that tinyobjloader takes on trust, and records where they stand.
/// \throws InputError naming `file` and the line: a coordinate that is not a finite number, a corner that names no
/// vertex.
ObjScan scan_obj(std::string_view text, const std::string& file);

/// The statements of an MTL material on its transparency.
struct MtlTransparency {
  std::optional<double> dissolve;      ///< d: 1 is opaque
  std::optional<double> transparency;  ///< Tr: 0 is opaque
  std::optional<Spectrum> filter;      ///< Tf
  std::optional<double> index;         ///< Ni
  int illumination = 0;                ///< illum
};

/// The pane that it makes of the material.
struct MtlPane {
  Spectrum transmittance;
  double index = 0;                       ///< of refraction
  std::string statement;                  ///< "d 0.3"
  std::optional<Spectrum> reflectance{};  ///< where it has holes: what is left of the material's
};

/// The pane that a material is; nothing where it is opaque. d counts before Tr, and Tf colors what they let through.
/// Without both Tf alone counts with an illumination for glass, unless it is 1 in all bands, as programs write it for
/// what is opaque.
std::optional<MtlPane> mtl_pane(const MtlTransparency& stated);

/// True when d and Tr contradict each other about whether the material is opaque: some programs mean opacity by Tr.
bool is_contradictory(const MtlTransparency& stated);

/// The statements of an MTL material on its reflection.
struct MtlReflection {
  Spectrum diffuse;                  ///< Kd
  std::optional<Spectrum> specular;  ///< Ks
  std::optional<double> exponent;    ///< Ns
  double roughness = 0;              ///< Pr
  double metallic = 0;               ///< Pm
  bool has_textures = false;         ///< of Ks, Ns, Pr or Pm
  int illumination = 0;              ///< illum
};

/// The mirror that it makes of the material.
struct MtlMirror {
  Spectrum specular_reflectance;
  Spectrum reflectance;   ///< what it reflects diffusely
  std::string statement;  ///< "illum 3"
};

/// The mirror that a material is; nothing where it is matt or glossy. An illumination with reflection makes one of what
/// has a Ks and is smooth. A metal reflects Kd, and nothing diffusely.
std::optional<MtlMirror> mtl_mirror(const MtlReflection& stated);

/// How a picture is put on: -s, -o and -clamp.
struct TextureOptions {
  Eigen::Vector2d scale{1, 1};
  Eigen::Vector2d offset{0, 0};
  bool clamp = false;
};

/// A material of an MTL file.
struct MtlMaterial {
  std::string name;
  Spectrum reflectance;                        ///< Kd
  Spectrum radiance;                           ///< Ke, W/(m^2 sr)
  Spectrum ambient;                            ///< Ka
  bool has_reflectance = false;                ///< Kd is given
  bool is_specular = false;                    ///< Ks is not 0
  std::vector<std::string> textures;           ///< the files of map_, bump, disp, refl and norm
  std::string diffuse_texture;                 ///< the file of map_Kd, by read_libraries() its place
  TextureOptions texture_options;              ///< those of map_Kd
  std::uint32_t texture_line = 0;              ///< on which map_Kd stands
  std::string mask_picture;                    ///< the file of map_d, by read_libraries() its place
  std::uint32_t mask_line = 0;                 ///< on which map_d stands
  bool has_ignored_mask = false;               ///< map_d has options that are not heeded; then it has no mask_picture
  bool has_mask = false;                       ///< the picture of map_d was read
  double covered = 1;                          ///< the share of the surface that map_d leaves
  bool has_mean = false;                       ///< the mean color of map_Kd is in the reflectance
  std::optional<TexturedReflectance> texture;  ///< what it is the mean of, where that has more than one color
  std::optional<MtlPane> pane;                 ///< what d, Tr, Tf, Ni and illum make of it
  std::optional<MtlMirror> mirror;             ///< what Ks, Ns, Pr, Pm and illum make of it, unless it is a pane
  bool is_contradictory = false;               ///< d and Tr contradict each other
  bool is_mirror_or_glass = false;             ///< illum 3 to 9
  bool is_metallic = false;                    ///< Pm is not 0
};

/// Reads the materials of an MTL file; of materials with the same name the first is kept.
/// \throws InputError naming `file` and the line when Kd, Ks, Ke or Tf is not three finite numbers, or d, Tr, Ni,
/// Ns, Pr or Pm is not one.
std::vector<MtlMaterial> read_mtl(const std::string& text, const std::string& file);

/// One sentence per property that these materials have and the simulation ignores.
Diagnostics notes_on_ignored(std::span<const MtlMaterial> materials);

/// The numbers of materials with properties that have a place in the plan.
std::vector<UnsimulatedMaterials> unsimulated(std::span<const MtlMaterial> materials);

}  // namespace patchlight
