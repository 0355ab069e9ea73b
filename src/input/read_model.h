#pragma once

#include "patchlight/scene/scene.h"

#include "input/radiance/radiance_material.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace patchlight {

struct XmlFile;

/// A model file as it stands, and the modifiers that it leaves to later Radiance files.
struct FileModel {
  Scene scene;
  RadianceModifiers modifiers;
};

/// The format of a file: its extension in lower case, without the dot, or that of which it is another name; the
/// standard input is OBJ.
std::string format_of(const std::filesystem::path& file);

/// \throws InputError at `where` unless the file is there and no folder. "-" always is. `near_names` lets the message
/// name a file of that folder which may be meant.
void require_file(const std::filesystem::path& file, const std::string& where, bool near_names = false);

/// One model file as it stands, in meters, before any setting or check. `format` is one of readable_formats() without
/// toml. `metres_per_unit` is used instead of the unit that the file states, if it is given. The file, and those that
/// it names, must lie in the folder `confine`, if there is one. `known` has the modifiers of files before it. \throws
/// InputError.
FileModel read_model(const std::filesystem::path& file, const std::string& format,
                     std::optional<double> metres_per_unit, const std::filesystem::path& confine,
                     RadianceModifiers known);

/// Several models as one scene, in their order; unit and upright axis are those of the first. Materials with the same
/// name and values become one; those with the same name and other values are kept apart, the later one named after its
/// file, "wall (b.obj)", and a note says so.
Scene merge_scenes(std::vector<Scene> scenes);

// The readers of the formats. Each returns vertices in meters, polygons, materials that faces use, groups, file,
// sha256, metres_per_unit and notes. Files that a model names must lie in the folder `confine`, if there is one.
// \throws InputError naming the file, and the line where there are lines.

/// The faces of an OFF, PLY or STL file, in ASCII or binary but for OFF. All have the material "default".
Scene read_off(const std::filesystem::path& file, double metres_per_unit);
Scene read_ply(const std::filesystem::path& file, double metres_per_unit);
Scene read_stl(const std::filesystem::path& file, double metres_per_unit);

/// An OBJ file and the MTL files it names.
Scene read_obj(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// A COLLADA file: faces, transformations, diffuse and emissive colors, pictures of diffuse ones, its unit and upright
/// axis.
Scene read_collada(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// Meters per unit of a COLLADA text: the attribute meter of its first <unit>; 1 without one.
double collada_unit(std::string_view text);

/// A glTF 2.0 file (.gltf with its buffers and textures, or .glb): triangles, transformations, base colors and
/// emission. Up is y.
Scene read_gltf(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// An IFC file: the geometry of its objects, and their colors as reflectances. Up is z. `metres_per_unit` replaces the
/// unit that the file states.
Scene read_ifc(const std::filesystem::path& file, std::optional<double> metres_per_unit);

/// A Mitsuba scene (XML, 0.5 to 3) and the files and meshes that it names, with luminaires, sun, sky and cameras.
Scene read_mitsuba(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// A honeybee model (HBJSON): rooms with their faces, apertures, doors and shades, orphaned ones too, with the
/// modifiers of faces and of modifier sets, else honeybee's generic ones by the kind of face; rooms, sensor grids and
/// views. Faces that two rooms share are there twice, openings between them once; air boundaries are holes. The unit is
/// the file's, `metres_per_unit` a further factor.
Scene read_hbjson(const std::filesystem::path& file, double metres_per_unit);

/// A gbXML building: its surfaces with their openings cut out, by its lengthUnit and a further factor. Windows are
/// panes with the visible transmittance of their type; the other materials are those of their kind of surface, with
/// usual reflectances, which notes state. Spaces are rooms, with the names of their storeys. Up is z.
Scene read_gbxml(const XmlFile& xml, double factor);

/// A Radiance scene file, and those that its !xform lines and instances name, beside it or in the current folder.
/// `known` has the modifiers that earlier files defined. No other program runs. Up is z. The lines of polygons are
/// those of the file itself.
FileModel read_radiance(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine,
                        RadianceModifiers known);

}  // namespace patchlight
