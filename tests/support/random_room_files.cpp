#include "support/random_rooms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace patchlight::test {
namespace {

// Twelve digits keep corners coplanar to 1e-9 m at 600 m from the origin.
std::string format(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.12g", std::abs(value) < 1e-12 ? 0.0 : value);
  return text.data();
}

// The room's rotation about z, and its unit of length.
struct Pose {
  Eigen::Matrix3d rotation;
  double units_per_metre;

  explicit Pose(const RandomRoom& room)
      : rotation(Eigen::AngleAxisd(room.turn * std::numbers::pi / 180, Vector::UnitZ()).toRotationMatrix()),
        units_per_metre(room.millimetres ? 1000 : 1) {}
  Vector direction(const Vector& vector) const { return rotation * vector; }
  Point point(const Point& point) const { return units_per_metre * (rotation * point); }
};

std::string format(const Vector& vector, const std::string& separator) {
  return format(vector.x()) + separator + format(vector.y()) + separator + format(vector.z());
}

std::string format_array(const Vector& vector) {
  std::ostringstream text;
  text << "[" << format(vector, ", ") << "]";
  return text.str();
}

// Texture coordinates of a corner: meters along the first edge of its face and across.
std::string texture_place(const RoomFace& face, const Point& corner) {
  const Vector along = (face.corners[1] - face.corners[0]).normalized();
  const Vector across = (face.corners[2] - face.corners[1]).normalized();
  const Vector from = corner - face.corners[0];
  return "vt " + format(from.dot(along)) + " " + format(from.dot(across)) + "\n";
}

bool has_texture(const RandomRoom& room, const std::string& name) {
  return std::any_of(room.materials.begin(), room.materials.end(),
                     [&](const RoomMaterial& material) { return material.has_texture && material.name == name; });
}

std::string obj_text(const RandomRoom& room) {
  const Pose pose(room);
  std::ostringstream text;
  text << "mtllib " << room.name << ".mtl\n";
  std::size_t vertices = 0, places = 0;
  for (const RoomFace& face : room.faces) {
    const bool textured = has_texture(room, face.material);
    for (const Point& corner : face.corners)
      text << "v " << format(pose.point(corner), " ") << "\n" << (textured ? texture_place(face, corner) : "");
    text << "g " << face.group << "\nusemtl " << face.material << "\nf";
    for (std::size_t k = 0; k < face.corners.size(); ++k) {
      text << " " << ++vertices;
      if (textured) text << "/" << ++places;
    }
    text << "\n";
  }
  return text.str();
}

std::string mtl_text(const RandomRoom& room) {
  std::ostringstream text;
  for (const RoomMaterial& material : room.materials) {
    const auto& [r, g, b] = material.reflectance;
    const std::string e = format(material.exitance / std::numbers::pi);  // Ke is a radiance
    text << "newmtl " << material.name << "\nKd " << format(r) << " " << format(g) << " " << format(b) << "\n";
    if (material.has_texture) text << "map_Kd " << room.name << ".ppm\n";
    if (material.exitance > 0) text << "Ke " << e << " " << e << " " << e << "\n";
  }
  return text.str();
}

// A share of each band; one number where all are equal.
std::string format_tinted(double share, const std::array<double, 3>& tint) {
  const auto& [r, g, b] = tint;
  return r == 1 && g == 1 && b == 1 ? format(share) : format_array(share * Vector(r, g, b));
}

std::string toml_materials(const RandomRoom& room) {
  std::ostringstream text;
  for (const RoomMaterial& material : room.materials) {
    const std::string head = "[[material]]\nname = \"" + material.name + "\"\n";
    if (material.transmittance > 0)
      text << head << "transmittance = " << format_tinted(material.transmittance, material.tint)
           << "\nindex = 1.52\n\n";
    if (material.specular_reflectance > 0)
      text << head << "specular_reflectance = " << format_tinted(material.specular_reflectance, material.tint)
           << "\n\n";
    if (material.diffuse_transmittance > 0)
      text << head << "diffuse_transmittance = " << format(material.diffuse_transmittance) << "\n\n";
  }
  return text.str();
}

std::string toml_luminaires(const RandomRoom& room) {
  const Pose pose(room);
  std::ostringstream text;
  for (const RoomLuminaire& lamp : room.luminaires) {
    text << "[[luminaire]]\nkind = \"" << lamp.kind << "\"\nposition = " << format_array(pose.point(lamp.position))
         << "\n";
    if (lamp.kind == "ies")
      text << "file = \"" << room.name << ".ies\"\nlumens = " << format(lamp.watts) << "\n";
    else
      text << "watts = " << format(lamp.watts) << "\n";
    if (lamp.kind == "spot" || lamp.kind == "ies") text << "aim = " << format_array(pose.direction(lamp.aim)) << "\n";
    if (lamp.kind == "spot")
      text << "beam_angle = " << format(lamp.beam_angle) << "\nfield_angle = " << format(lamp.field_angle) << "\n";
    if (lamp.kind == "sphere") text << "radius = " << format(lamp.radius * pose.units_per_metre) << "\n";
    text << "\n";
  }
  return text.str();
}

std::string toml_daylight(const RandomRoom& room) {
  if (!room.daylight) return "";
  const RoomDaylight& day = *room.daylight;
  const bool is_measured = day.sky == "perez";
  std::ostringstream text;
  if (day.has_sun) {
    text << "[sun]\ndirection = " << format_array(Pose(room).direction(day.sun)) << "\n";
    if (!is_measured) text << "irradiance = " << format(day.direct) << "\n";
    text << "\n";
  }
  text << "[sky]\nkind = \"" << day.sky << "\"\n";
  if (is_measured)
    text << "direct_normal = " << format(day.direct) << "\ndiffuse_horizontal = " << format(day.diffuse) << "\n\n";
  else
    text << "irradiance = " << format(day.diffuse) << "\n\n";
  text << "[ground]\nreflectance = " << format(day.horizon_below) << "\n\n";
  return text.str();
}

std::string toml_sensors(const RandomRoom& room) {
  const Pose pose(room);
  std::ostringstream text;
  text << "[[sensors]]\nname = \"room\"\npoints = [";
  for (const RoomSensor& sensor : room.sensors)
    text << "\n  [" << format(pose.point(sensor.point), ", ") << ", " << format(pose.direction(sensor.normal), ", ")
         << "],";
  text << "\n]\n";
  return text.str();
}

std::string toml_text(const RandomRoom& room) {
  const std::string unit = room.millimetres ? "unit = \"mm\"\n" : "";
  return "up = \"z\"\n" + unit + "\n[[model]]\nfile = \"" + room.name + ".obj\"\n" + unit + "\n" +
         toml_materials(room) + toml_luminaires(room) + toml_daylight(room) + toml_sensors(room);
}

// A downlight of 1000 lm with its largest intensity at 30 degrees.
std::string ies_text() {
  std::ostringstream angles, candela;
  for (int degrees = 0; degrees <= 90; degrees += 5) {
    const double radians = degrees * std::numbers::pi / 180;
    angles << degrees << " ";
    candela << format(std::round(400 * std::cos(radians) * (1 + 0.8 * std::sin(2 * radians) * std::cos(radians))))
            << " ";
  }
  return "IESNA:LM-63-2002\n[TEST] batwing downlight\nTILT=NONE\n1 1000 1 19 1 1 2 0 0 0\n1 1 10\n" + angles.str() +
         "\n0\n" + candela.str() + "\n";
}

// A board of 8 x 8 squares in two colors.
std::string ppm_text() {
  std::string text = "P6\n8 8\n255\n";
  for (int k = 0; k < 64; ++k) text += (k + k / 8) % 2 == 0 ? "\xff\xff\xff" : "\xb0\x90\x70";
  return text;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

std::filesystem::path write_random_room(const RandomRoom& room, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const std::filesystem::path base = folder / room.name;
  const auto with = [&](const char* extension) { return std::filesystem::path(base.string() + extension); };
  write_text(with(".obj"), obj_text(room));
  write_text(with(".mtl"), mtl_text(room));
  write_text(with(".toml"), toml_text(room));
  const auto is_measured = [](const RoomLuminaire& lamp) { return lamp.kind == "ies"; };
  if (std::any_of(room.luminaires.begin(), room.luminaires.end(), is_measured)) write_text(with(".ies"), ies_text());
  const auto is_textured = [](const RoomMaterial& material) { return material.has_texture; };
  if (std::any_of(room.materials.begin(), room.materials.end(), is_textured)) write_text(with(".ppm"), ppm_text());
  return with(".toml");
}

}  // namespace patchlight::test
