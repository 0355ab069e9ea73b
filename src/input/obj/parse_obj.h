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

/// A name in an OBJ file, and its line.
struct ObjName {
  std::string name;
  std::uint32_t line = 0;
};

/// The material of faces before any usemtl.
inline constexpr std::uint32_t no_material = ~std::uint32_t{0};

/// The texture point of a corner without a valid one.
inline constexpr std::uint32_t no_place = ~std::uint32_t{0};

/// The data of a face from its own line and the lines before.
struct ObjFace {
  std::uint32_t line = 0;
  std::uint32_t material = no_material;  ///< index into ObjScan::materials
  std::vector<std::uint32_t> corners;    ///< from 0, if too many for tinyobjloader; else empty
  std::size_t first_place = 0;           ///< index into ObjScan::places of its first corner
};

/// An OBJ file with verified numbers and indices.
struct ObjScan {
  std::vector<Point> vertices;                  ///< in model units
  std::vector<ObjFace> faces;                   ///< in file order
  std::vector<Eigen::Vector2d> picture_points;  ///< the vt statements, v from the bottom
  std::vector<std::uint32_t> places;            ///< per corner of each face: a picture point, or no_place
  std::vector<ObjName> materials;               ///< the names after usemtl, each once
  std::vector<ObjName> libraries;               ///< texts after each mtllib
  std::string geometry;  ///< v, f, g and o statements, one per line; faces have vertices only, and only the first three
                         ///< where ObjFace::corners has all
  LeftOut left_out;      ///< faces with fewer than 3 corners, lines, points and free-form surfaces
  std::size_t colored_vertices = 0;  ///< v statements with a color after the coordinates
};

/// Verifies the statements of an OBJ file that tinyobjloader does not check. Records their lines.
/// \throws InputError with `file` and line for a coordinate that is not finite, or a corner without a vertex.
ObjScan scan_obj(std::string_view text, const std::string& file);

/// The statements of an MTL material on transparency.
struct MtlTransparency {
  std::optional<double> dissolve;      ///< d: 1 is opaque
  std::optional<double> transparency;  ///< Tr: 0 is opaque
  std::optional<Spectrum> filter;      ///< Tf
  std::optional<double> index;         ///< Ni
  int illumination = 0;                ///< illum
};

/// The pane of an MTL material.
struct MtlPane {
  Spectrum transmittance;
  double index = 0;                       ///< of refraction
  std::string statement;                  ///< "d 0.3"
  std::optional<Spectrum> reflectance{};  ///< of the covered part, for panes with holes
};

/// The pane of a material; empty if opaque. d has precedence over Tr, and Tf colors the transmitted light. Tf alone
/// makes a pane only with a glass illumination model. A Tf of 1 in all bands does not: programs write it for opaque
/// materials.
std::optional<MtlPane> mtl_pane(const MtlTransparency& stated);

/// True when one of d and Tr makes the material opaque and the other does not: some programs write opacity as Tr.
bool is_contradictory(const MtlTransparency& stated);

/// The statements of an MTL material on reflection.
struct MtlReflection {
  Spectrum diffuse;                  ///< Kd
  std::optional<Spectrum> specular;  ///< Ks
  std::optional<double> exponent;    ///< Ns
  double roughness = 0;              ///< Pr
  double metallic = 0;               ///< Pm
  bool has_textures = false;         ///< for Ks, Ns, Pr or Pm
  int illumination = 0;              ///< illum
};

/// The mirror of an MTL material.
struct MtlMirror {
  Spectrum specular_reflectance;
  Spectrum reflectance;   ///< diffuse reflectance
  std::string statement;  ///< "illum 3"
};

/// The mirror of a material; empty if matt or glossy. A smooth material with Ks and a reflecting illumination model is
/// a mirror. A metal reflects Kd specularly and has no diffuse reflection.
std::optional<MtlMirror> mtl_mirror(const MtlReflection& stated);

/// Texture options -s, -o and -clamp.
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
  std::vector<std::string> textures;           ///< files of map_, bump, disp, refl and norm
  std::string diffuse_texture;                 ///< file of map_Kd; read_libraries() makes it a path
  TextureOptions texture_options;              ///< options of map_Kd
  std::uint32_t texture_line = 0;              ///< line of map_Kd
  std::string mask_picture;                    ///< file of map_d; read_libraries() makes it a path
  std::uint32_t mask_line = 0;                 ///< line of map_d
  bool has_ignored_mask = false;               ///< map_d has unsupported options; mask_picture is then empty
  bool has_mask = false;                       ///< the picture of map_d was read
  double covered = 1;                          ///< fraction of the surface that map_d covers
  bool has_mean = false;                       ///< the reflectance includes the mean color of map_Kd
  std::optional<TexturedReflectance> texture;  ///< the texture, if it has more than one color
  std::optional<MtlPane> pane;                 ///< from d, Tr, Tf, Ni and illum
  std::optional<MtlMirror> mirror;             ///< from Ks, Ns, Pr, Pm and illum; never together with a pane
  bool is_contradictory = false;               ///< d and Tr contradict each other
  bool is_mirror_or_glass = false;             ///< illum 3 to 9
  bool is_metallic = false;                    ///< Pm is not 0
};

/// Reads the materials of an MTL file. Among materials with the same name the first one is used.
/// \throws InputError with `file` and line. Kd, Ks, Ke and Tf need three finite numbers; d, Tr, Ni, Ns, Pr and Pm need
/// one.
std::vector<MtlMaterial> read_mtl(const std::string& text, const std::string& file);

/// One sentence per material property that the simulation ignores.
Diagnostics notes_on_ignored(std::span<const MtlMaterial> materials);

/// The numbers of materials with properties that may be simulated later.
std::vector<UnsimulatedMaterials> unsimulated(std::span<const MtlMaterial> materials);

}  // namespace patchlight
