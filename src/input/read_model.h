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

/// A model file as read, and the modifiers that it passes to later Radiance files.
struct FileModel {
  Scene scene;
  RadianceModifiers modifiers;
};

/// The format of a file: its extension in lower case without the dot, with synonyms resolved. The standard input is
/// OBJ.
std::string format_of(const std::filesystem::path& file);

/// \throws InputError at `where` unless the file exists and is no folder; "-" always passes. With `near_names` the
/// message suggests a similar name in the folder.
void require_file(const std::filesystem::path& file, const std::string& where, bool near_names = false);

/// One model file in meters, before settings and checks. `format` is one of readable_formats() except toml.
/// `metres_per_unit`, if given, replaces the unit of the file. The file and those that it names must lie in the folder
/// `confine`, if given. `known` holds the modifiers of earlier files. \throws InputError.
FileModel read_model(const std::filesystem::path& file, const std::string& format,
                     std::optional<double> metres_per_unit, const std::filesystem::path& confine,
                     RadianceModifiers known);

/// Several models as one scene, in order. Unit and vertical axis come from the first. Materials with the same name and
/// values are merged. For other values the later material is renamed after its file, "wall (b.obj)", with a note.
Scene merge_scenes(std::vector<Scene> scenes);

// Readers of the formats. Each returns vertices in meters, polygons, used materials, groups, file, sha256,
// metres_per_unit and notes. Files that a model names must lie in the folder `confine`, if given. \throws InputError
// with the file and, in text formats, the line.

/// The faces of an OFF, PLY or STL file. PLY and STL may be binary. All faces have the material "default".
Scene read_off(const std::filesystem::path& file, double metres_per_unit);
Scene read_ply(const std::filesystem::path& file, double metres_per_unit);
Scene read_stl(const std::filesystem::path& file, double metres_per_unit);

/// An OBJ file and the MTL files it names.
Scene read_obj(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// A COLLADA file: faces, transformations, diffuse and emissive colors, textures of diffuse colors, unit and vertical
/// axis.
Scene read_collada(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// Meters per unit of a COLLADA text: the attribute meter of its first <unit>; default 1.
double collada_unit(std::string_view text);

/// A glTF 2.0 file (.gltf with buffers and textures, or .glb): triangles, transformations, base colors and emission.
/// The vertical axis is y.
Scene read_gltf(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// An IFC file: the geometry of its objects, with their colors as reflectances. The vertical axis is z.
/// `metres_per_unit` replaces the unit of the file.
Scene read_ifc(const std::filesystem::path& file, std::optional<double> metres_per_unit);

/// A Mitsuba scene (XML, 0.5 to 3) and the files and meshes that it names, with luminaires, sun, sky and cameras.
Scene read_mitsuba(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine);

/// A honeybee model (HBJSON): rooms with faces, apertures, doors and shades, orphaned ones too; sensor grids and views.
/// Modifiers come from faces, modifier sets, or honeybee's generic set by kind of face. A face between two rooms occurs
/// twice, an opening once; air boundaries are holes. `metres_per_unit` multiplies the unit of the file.
Scene read_hbjson(const std::filesystem::path& file, double metres_per_unit);

/// A gbXML building: surfaces with openings cut out, in its lengthUnit times `factor`. Windows are panes with the
/// visible transmittance of their type. Other materials have typical reflectances of their kind of surface, with notes.
/// Spaces are rooms, named with their stories. The vertical axis is z.
Scene read_gbxml(const XmlFile& xml, double factor);

/// A Radiance scene file and the files of its !xform lines and instances, beside it or in the current folder. `known`
/// holds modifiers of earlier files. No other program runs. The vertical axis is z. Lines of polygons refer to the file
/// itself.
FileModel read_radiance(const std::filesystem::path& file, double metres_per_unit, const std::filesystem::path& confine,
                        RadianceModifiers known);

}  // namespace patchlight
