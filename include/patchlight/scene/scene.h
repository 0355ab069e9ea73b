#pragma once

#include "patchlight/base/diagnostics.h"
#include "patchlight/base/geometry.h"
#include "patchlight/light/material.h"
#include "patchlight/scene/daylight.h"
#include "patchlight/scene/luminaire.h"
#include "patchlight/scene/sensor.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace patchlight {

/// Place of a polygon in Scene::polygons.
using PolygonIndex = std::uint32_t;

/// Stands for "no polygon".
inline constexpr PolygonIndex no_polygon = ~PolygonIndex{0};

/// The two sides of a polygon: from the front its corners run counter-clockwise.
enum class Side : std::uint8_t { front, back };

/// "front" or "back".
const char* name_of(Side side);

/// Where points lie in the picture of a material: (u, v) = linear * x + offset, x in meters.
struct TextureMap {
  Eigen::Matrix<double, 2, 3> linear;  ///< 1/m
  Eigen::Vector2d offset;
};

/// The texture map of polygons without known texture coordinates.
inline constexpr std::uint32_t no_texture_map = ~std::uint32_t{0};

/// A planar polygon of the model, not necessarily convex. A seam, traversed both ways, joins a hole to the outline.
struct Polygon {
  std::vector<std::uint32_t> corners;  ///< indices into Scene::vertices, at least three
  MaterialIndex material = 0;
  std::uint32_t group = 0;  ///< index into Scene::groups
  std::uint32_t line = 0;   ///< in the model file, from 1; 0 if unknown
  std::uint32_t file = 0;   ///< index into Scene::files
  std::uint32_t face = 0;   ///< number of its face in the model's files, from 0; given by read_scene()
  std::optional<MaterialIndex> back_material{};     ///< of its back side, when that is a face of its own
  std::uint32_t texture_map = no_texture_map;       ///< index into Scene::texture_maps
  std::uint32_t back_texture_map = no_texture_map;  ///< that of the back material
};

/// A room that a model names, as IfcSpace does: a body of air.
struct NamedRoom {
  std::string name;                       ///< "A102"
  std::string storey = {};                ///< "Level1"; empty if unknown
  std::vector<std::vector<Point>> faces;  ///< corners, meters
};

/// How a camera maps directions to its picture.
enum class Projection : std::uint8_t {
  perspective,    ///< straight lines stay straight
  orthographic,   ///< parallel rays from the plane through the eye: plans, and sections along that plane
  angular,        ///< fisheye: the distance from the middle is in proportion to the angle
  hemispherical,  ///< fisheye: in proportion to its sine, so that the area is the projected solid angle
  panorama        ///< all around: azimuth by altitude, 360 degrees by the field of view
};

/// "perspective", "orthographic", "angular", "hemispherical" or "panorama", as in scene files.
const char* name_of(Projection projection);

/// The projection of that name; nothing for other names.
std::optional<Projection> projection_named(const std::string& name);

/// The default vertical field of view of a camera, degrees.
double usual_field_of_view(Projection projection);

/// The largest vertical field of view of a camera, degrees. A perspective stays below it.
double largest_field_of_view(Projection projection);

/// The viewpoint of a picture.
struct Camera {
  Point eye;
  Point target;
  double vertical_field_of_view = 50;  ///< degrees
  std::string name = {};               ///< in a scene file
  Projection projection = Projection::perspective;
  double height = 0;  ///< of the part that an orthographic picture shows, meters
};

/// False if the projection of a camera does not allow its field of view or its height.
bool has_extent(const Camera& camera);

/// A material that may be meant as a lamp.
struct LampHint {
  std::string material;
  Spectrum radiance;   ///< that it may be meant to emit, W/(m^2 sr)
  std::string reason;  ///< "its Ka is 20, 20, 20"
};

/// A property of surfaces that is not simulated: they are treated as matte and opaque.
enum class UnsimulatedProperty : std::uint8_t { mirror, glass };

/// The number of materials of a model's files with this property.
struct UnsimulatedMaterials {
  UnsimulatedProperty property = UnsimulatedProperty::mirror;
  std::size_t materials = 0;
};

/// How the bands of a scene with spectra were chosen, in words.
struct BandChoice {
  bool spectral = true;  ///< not linear RGB
  std::string reason;    ///< "1 of 3 materials has a spectrum; 12 bands keep colors within 0.8 dE00"
  std::string saving;    ///< "12 of 81 bands"
};

/// A model: polygons with materials, in meters. Lamps are polygons whose material has an exitance; besides them there
/// may be luminaires, sun and sky.
struct Scene {
  std::vector<Point> vertices;  ///< meters
  std::vector<Polygon> polygons;
  std::size_t faces = 0;  ///< that the files have; read_scene() may cut and join them
  std::vector<Material> materials;
  std::vector<TextureMap> texture_maps;       ///< of polygons whose materials have pictures
  Bands bands;                                ///< the meaning of the bands of all spectra; empty: see bands_of()
  std::vector<std::string> groups;            ///< names of objects and groups
  std::string file;                           ///< the model file's name, for messages
  std::vector<std::string> files;             ///< the files the polygons come from; empty when `file` is the only one
  std::vector<std::filesystem::path> inputs;  ///< every file that was read for it, or that its materials name
  std::string sha256;                         ///< of the model file and its material files, hexadecimal
  double metres_per_unit = 1;                 ///< length of one unit of the model file
  bool unit_stated = false;                   ///< the model files state their unit, and no caller gave another
  Vector up = Vector::UnitZ();
  bool up_stated = false;          ///< the model file or the caller defines the vertical axis
  Vector north = Vector::UnitY();  ///< unit, at right angles to up
  bool north_stated = false;       ///< by the model file
  std::vector<Luminaire> luminaires;
  std::optional<Sun> sun;
  std::optional<Sky> sky;
  std::vector<UnsimulatedMaterials> unsimulated;  ///< counted per file that the scene comes from
  Diagnostics diagnostics;                        ///< findings on the model, worst first, then those of later steps
  std::vector<LampHint> lamp_hints;               ///< materials that do not emit, but may be meant to
  bool photometric = false;                       ///< lights are stated in lumens or lux: illuminance has a meaning
  std::vector<SensorGroup> sensors;               ///< groups of points at which irradiance is computed
  std::vector<Camera> cameras;                    ///< viewpoints of pictures
  std::vector<NamedRoom> rooms;                   ///< that the models name
  std::optional<BandChoice> band_choice{};        ///< empty without spectra and without requested bands
};

/// The number of bands of the scene's spectra. There must be a material.
Eigen::Index number_of_bands(const Scene& scene);

/// The meaning of its bands: Scene::bands, else usual_bands().
Bands bands_of(const Scene& scene);

/// The diagnostics that cannot make all results wrong.
Diagnostics remarks_of(const Scene& scene);

/// The corner points of a polygon.
std::vector<Point> corner_points(const Scene& scene, PolygonIndex polygon);

/// The corner points of an outline of vertices.
std::vector<Point> corner_points(const Scene& scene, std::span<const std::uint32_t> outline);

/// The area of a polygon, m^2.
double polygon_area(const Scene& scene, PolygonIndex polygon);

/// The box around a polygon.
Box polygon_box(const Scene& scene, PolygonIndex polygon);

/// The unit normal of a polygon's front side; zero for a polygon without area.
Vector front_normal(const Scene& scene, PolygonIndex polygon);

/// The material of one side of a polygon.
MaterialIndex material_on(const Polygon& polygon, Side side);

/// The texture map of one side of a polygon. Null if its material has no texture or the coordinates are unknown; then
/// the reflectance of the material applies.
const TextureMap* texture_map_on(const Scene& scene, const Polygon& polygon, Side side);

/// True when this side of the polygon emits in any band: the front side with the polygon's material, the back side only
/// with a material of its own.
bool emits(const Scene& scene, PolygonIndex polygon, Side side);

/// True when one of the polygon's sides emits.
bool is_lamp(const Scene& scene, PolygonIndex polygon);

/// True when something gives light: a polygon that is a lamp, a luminaire, sun or sky.
bool has_lamp(const Scene& scene);

/// True when there is light from elsewhere than polygons: luminaires, sun or sky.
bool has_point_or_daylight(const Scene& scene);

/// True when the polygon is a clear opening: one of its sides has a transmittance above 0 in some band.
bool is_opening(const Scene& scene, PolygonIndex polygon);

/// True when this side of the polygon is a mirror: its specular reflectance is above 0 in some band.
bool is_mirror(const Scene& scene, PolygonIndex polygon, Side side);

/// True if the polygon is a translucent sheet: the material of its front has a diffuse transmittance above 0 in some
/// band. Light that arrives on one side is also scattered out of the other. check() requires the same diffuse
/// transmittance on the back.
bool is_sheet(const Scene& scene, PolygonIndex polygon);

/// Guesses the axis that points up, for models whose files do not state it. Floors and ceilings give the axis, y or z,
/// with a quarter more area across it than across the other. If neither has, y if the lamps shine against it within 30
/// degrees, else z.
Vector upright_axis(const Scene& scene);

/// The location of a polygon for messages: "room.obj:12", or the file alone if the line is unknown.
std::string place_of(const Scene& scene, const Polygon& polygon);

/// The name of an object or group; "object 3" for one without.
std::string group_name(const Scene& scene, std::uint32_t group);

/// Bounds of all vertices that polygons use.
Box bounds(const Scene& scene);

/// Checks the conditions of repair(): finite vertices, corners in range, at most 10,000 corners per polygon.
/// \throws InputError naming the file and line.
void check_vertices(const Scene& scene);

/// Checks the conditions of every later step:
/// - those of check_vertices();
/// - at least one polygon, and only planar polygons with area;
/// - a model of 1e-12 m or more;
/// - one of Scene::bands for each band, if there are any;
/// - reflectance in [0, 1];
/// - at most one of transmittance, specular reflectance and diffuse transmittance, not negative;
/// - a sum of that and the reflectance of at most 1;
/// - the same diffuse transmittance on both sides of a polygon;
/// - exitance finite and not negative.
/// \throws InputError naming the file and line, or the material.
void check(const Scene& scene);

}  // namespace patchlight
