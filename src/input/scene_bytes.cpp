#include "input/scene_bytes.h"

#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>

namespace patchlight {
namespace {

class Writer {
 public:
  template <typename Value>
  void plain(const Value& value) {
    static_assert(std::is_arithmetic_v<Value>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void text(const std::string& text) {
    plain(text.size());
    bytes_ += text;
  }
  template <typename Vector>
  void numbers(const Vector& values) {
    plain(static_cast<std::size_t>(values.size()));
    for (const auto value : values) plain(value);
  }
  std::string bytes() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <typename Value>
  Value plain() {
    if (bytes_.size() < sizeof(Value)) throw std::runtime_error("a message ends early");
    Value value;
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  // How many things follow, each of a byte or more.
  std::size_t count() {
    const auto count = plain<std::size_t>();
    if (count > bytes_.size()) throw std::runtime_error("a message ends early");
    return count;
  }
  std::string text() {
    const std::size_t size = count();
    std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return text;
  }
  Spectrum spectrum() {
    Spectrum values(static_cast<Eigen::Index>(count()));
    for (double& value : values) value = plain<double>();
    return values;
  }
  Point point() {
    Point values;
    if (count() != 3) throw std::runtime_error("a point has not three coordinates");
    for (double& value : values) value = plain<double>();
    return values;
  }

 private:
  std::string_view bytes_;
};

void write_polygon(Writer& out, const Polygon& polygon) {
  out.numbers(polygon.corners);
  out.plain(polygon.material);
  out.plain(polygon.group);
  out.plain(polygon.line);
}

Polygon read_polygon(Reader& in) {
  Polygon polygon;
  polygon.corners.resize(in.count());
  for (std::uint32_t& corner : polygon.corners) corner = in.plain<std::uint32_t>();
  polygon.material = in.plain<MaterialIndex>();
  polygon.group = in.plain<std::uint32_t>();
  polygon.line = in.plain<std::uint32_t>();
  return polygon;
}

void write_stated(Writer& out, const std::optional<StatedSurface>& stated) {
  out.plain(stated.has_value());
  if (!stated) return;
  out.text(stated->by);
  out.numbers(stated->matt_reflectance);
}

std::optional<StatedSurface> read_stated(Reader& in) {
  if (!in.plain<bool>()) return std::nullopt;
  StatedSurface stated;
  stated.by = in.text();
  stated.matt_reflectance = in.spectrum();
  return stated;
}

void write_material(Writer& out, const Material& material) {
  out.text(material.name);
  out.numbers(material.reflectance);
  out.numbers(material.exitance);
  out.numbers(material.transmittance);
  out.plain(material.index);
  out.numbers(material.specular_reflectance);
  out.numbers(material.diffuse_transmittance);
  write_stated(out, material.stated_pane);
  write_stated(out, material.stated_mirror);
}

Material read_material(Reader& in) {
  Material material;
  material.name = in.text();
  material.reflectance = in.spectrum();
  material.exitance = in.spectrum();
  material.transmittance = in.spectrum();
  material.index = in.plain<double>();
  material.specular_reflectance = in.spectrum();
  material.diffuse_transmittance = in.spectrum();
  material.stated_pane = read_stated(in);
  material.stated_mirror = read_stated(in);
  return material;
}

void write_room(Writer& out, const NamedRoom& room) {
  out.text(room.name);
  out.text(room.storey);
  out.plain(room.faces.size());
  for (const std::vector<Point>& face : room.faces) {
    out.plain(face.size());
    for (const Point& corner : face) out.numbers(corner);
  }
}

NamedRoom read_room(Reader& in) {
  NamedRoom room;
  room.name = in.text();
  room.storey = in.text();
  room.faces.resize(in.count());
  for (std::vector<Point>& face : room.faces) {
    face.resize(in.count());
    for (Point& corner : face) corner = in.point();
  }
  return room;
}

}  // namespace

std::string scene_bytes(const Scene& scene) {
  Writer out;
  out.plain(scene.vertices.size());
  for (const Point& vertex : scene.vertices) out.numbers(vertex);
  out.plain(scene.polygons.size());
  for (const Polygon& polygon : scene.polygons) write_polygon(out, polygon);
  out.plain(scene.materials.size());
  for (const Material& material : scene.materials) write_material(out, material);
  for (const auto* texts : {&scene.groups, &scene.notes}) {
    out.plain(texts->size());
    for (const std::string& text : *texts) out.text(text);
  }
  out.plain(scene.inputs.size());
  for (const std::filesystem::path& file : scene.inputs) out.text(file.string());
  out.plain(scene.unsimulated.size());
  for (const UnsimulatedMaterials& found : scene.unsimulated) {
    out.plain(static_cast<std::uint8_t>(found.property));
    out.plain(found.materials);
  }
  out.plain(scene.rooms.size());
  for (const NamedRoom& room : scene.rooms) write_room(out, room);
  out.text(scene.file);
  out.text(scene.sha256);
  out.plain(scene.metres_per_unit);
  out.numbers(scene.up);
  out.plain(scene.up_stated);
  return std::move(out).bytes();
}

Scene scene_from_bytes(std::string_view bytes) {
  Reader in(bytes);
  Scene scene;
  scene.vertices.resize(in.count());
  for (Point& vertex : scene.vertices) vertex = in.point();
  scene.polygons.resize(in.count());
  for (Polygon& polygon : scene.polygons) polygon = read_polygon(in);
  scene.materials.resize(in.count());
  for (Material& material : scene.materials) material = read_material(in);
  for (auto* texts : {&scene.groups, &scene.notes}) {
    texts->resize(in.count());
    for (std::string& text : *texts) text = in.text();
  }
  scene.inputs.resize(in.count());
  for (std::filesystem::path& file : scene.inputs) file = in.text();
  scene.unsimulated.resize(in.count());
  for (UnsimulatedMaterials& found : scene.unsimulated) {
    found.property = static_cast<UnsimulatedProperty>(in.plain<std::uint8_t>());
    found.materials = in.plain<std::size_t>();
  }
  scene.rooms.resize(in.count());
  for (NamedRoom& room : scene.rooms) room = read_room(in);
  scene.file = in.text();
  scene.sha256 = in.text();
  scene.metres_per_unit = in.plain<double>();
  scene.up = in.point();
  scene.up_stated = in.plain<bool>();
  return scene;
}

}  // namespace patchlight
