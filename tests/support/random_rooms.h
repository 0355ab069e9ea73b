#pragma once

#include "patchlight/base/geometry.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patchlight::test {

/// A planar face; its front is the side from which the corners run counter-clockwise.
struct RoomFace {
  std::string group;
  std::string material;
  std::vector<Point> corners;  ///< meters
};

/// A material of three bands. A pane has a transmittance, a mirror a specular reflectance, a sheet a diffuse
/// transmittance.
struct RoomMaterial {
  std::string name;
  std::array<double, 3> reflectance{};
  double exitance = 0;  ///< W/m^2
  double transmittance = 0;
  double specular_reflectance = 0;
  double diffuse_transmittance = 0;
  std::array<double, 3> tint{1, 1, 1};  ///< factors of transmittance and specular reflectance per band
  bool has_texture = false;             ///< dark and light squares multiply the reflectance
};

/// A lamp without a polygon.
struct RoomLuminaire {
  std::string kind = {};           ///< "point", "spot", "sphere" or "ies"
  Point position = Point::Zero();  ///< meters
  Vector aim = -Vector::UnitZ();
  double watts = 0;        ///< per band; lumens for "ies"
  double beam_angle = 0;   ///< degrees, for "spot"
  double field_angle = 0;  ///< degrees, for "spot"
  double radius = 0;       ///< meters, for "sphere"
};

/// Sun and sky.
struct RoomDaylight {
  Vector sun;                ///< unit direction toward the sun
  std::string sky;           ///< "clear", "overcast", "uniform" or "perez"
  bool has_sun = true;       ///< "perez" derives the strength of its sun from the measured irradiance
  double direct = 0;         ///< normal irradiance by the sun, W/m^2
  double diffuse = 0;        ///< horizontal irradiance by the sky, W/m^2
  double horizon_below = 0;  ///< reflectance of the ground below the horizon
};

/// A sensor: position in meters and direction.
struct RoomSensor {
  Point point;
  Vector normal;
};

/// A room as plain numbers: z is up, and the air volume of the room extends from the origin to `size`.
struct RandomRoom {
  std::string name;              ///< "overhang_07"
  std::string kind;              ///< "overhang"
  Vector size = Vector::Zero();  ///< meters
  std::vector<RoomMaterial> materials = {};
  std::vector<RoomFace> faces = {};
  std::vector<RoomLuminaire> luminaires = {};
  std::optional<RoomDaylight> daylight = {};
  std::vector<RoomSensor> sensors = {};
  double turn = 0;           ///< degrees about z, applied when the room is written
  bool millimetres = false;  ///< the files state lengths in millimeters
};

/// The kinds of rooms lit by sun and sky, and of those lit by lamps.
std::vector<std::string> daylight_kinds();
std::vector<std::string> lamp_kinds();

/// The surfaces in a room besides those of its kind.
enum class RoomOptics : std::uint8_t {
  plain,  ///< none
  mixed   ///< colored panes, mirrors and sheets that stand in the room, and often tinted windows and a textured floor
};

/// Room number `number` of a kind. The same arguments give the same room.
RandomRoom make_random_room(const std::string& kind, std::size_t number, std::uint64_t seed,
                            RoomOptics optics = RoomOptics::plain);

/// Writes the room as `name`.toml, .obj, .mtl and, for lamps of kind "ies", .ies; for textures .ppm. Returns the path
/// of the TOML file.
std::filesystem::path write_random_room(const RandomRoom& room, const std::filesystem::path& folder);

}  // namespace patchlight::test
