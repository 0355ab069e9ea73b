#pragma once

#include "patchlight/base/geometry.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

// One small room as a list of triangles, written in every format.
namespace patchlight::test {

struct Triangles {
  std::vector<Point> vertices;
  std::vector<std::array<std::uint32_t, 3>> corners;
};

/// The twelve triangles of a box, with fronts inward or outward.
inline Triangles with_box(Triangles shape, const Point& low, const Point& high, bool inward) {
  const auto first = static_cast<std::uint32_t>(shape.vertices.size());
  for (const double z : {low.z(), high.z()}) {
    for (const double y : {low.y(), high.y()}) {
      for (const double x : {low.x(), high.x()}) shape.vertices.emplace_back(x, y, z);
    }
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> faces = {
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& face : faces) {
    for (const std::size_t k : {1U, 2U}) {
      const std::uint32_t second = face[inward ? k : k + 1];
      const std::uint32_t third = face[inward ? k + 1 : k];
      shape.corners.push_back({first + face[0], first + second, first + third});
    }
  }
  return shape;
}

/// A closed room of 3 x 2.4 x 2.1 m with a floating box in it. Most coordinates are not binary fractions.
inline Triangles room() {
  Triangles shape = with_box(Triangles(), Point(0, 0, 0), Point(3, 2.4, 2.1), true);
  return with_box(shape, Point(1.1, 0.7, 0.3), Point(1.9, 1.3, 0.9), false);
}

/// A lamp of 0.6 x 0.5 m below the ceiling that shines down, as OBJ and MTL.
constexpr const char* lamp_obj =
    "mtllib lamp.mtl\nv 0.3 0.4 2\nv 0.3 0.9 2\nv 0.9 0.9 2\nv 0.9 0.4 2\nusemtl lamp\nf 1 2 3 4\n";
constexpr const char* lamp_mtl = "newmtl lamp\nKd 0 0 0\nKe 10 9 8\n";

inline std::string text(const Point& p, const char* separator = " ") {
  std::ostringstream out;
  out.precision(17);
  out << p.x() << separator << p.y() << separator << p.z();
  return out.str();
}

inline std::string as_obj(const Triangles& shape) {
  std::ostringstream out;
  for (const Point& p : shape.vertices) out << "v " << text(p) << '\n';
  for (const auto& [a, b, c] : shape.corners) out << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
  return out.str();
}

inline std::string as_ply(const Triangles& shape) {
  std::ostringstream out;
  out << "ply\nformat ascii 1.0\nelement vertex " << shape.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << shape.corners.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Point& p : shape.vertices) out << text(p) << '\n';
  for (const auto& [a, b, c] : shape.corners) out << "3 " << a << ' ' << b << ' ' << c << '\n';
  return out.str();
}

/// The bytes of a number, in either order.
template <typename Value>
std::string bytes_of(Value value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline std::string as_binary_ply(const Triangles& shape, bool big_endian) {
  std::string bytes = as_ply(shape);
  bytes.resize(bytes.find("end_header\n") + 11);
  bytes.replace(bytes.find("ascii"), 5, big_endian ? "binary_big_endian" : "binary_little_endian");
  for (const Point& p : shape.vertices) {
    for (int axis = 0; axis < 3; ++axis) bytes += bytes_of(p[axis], big_endian);
  }
  for (const auto& triangle : shape.corners) {
    bytes += bytes_of(std::uint8_t{3});
    for (const std::uint32_t corner : triangle) bytes += bytes_of(static_cast<std::int32_t>(corner), big_endian);
  }
  return bytes;
}

inline std::string as_binary_stl(const Triangles& shape) {
  std::string bytes(80, ' ');
  bytes += bytes_of(static_cast<std::uint32_t>(shape.corners.size()));
  for (const auto& triangle : shape.corners) {
    bytes += std::string(12, '\0');
    for (const std::uint32_t corner : triangle) {
      for (int axis = 0; axis < 3; ++axis) bytes += bytes_of(static_cast<float>(shape.vertices[corner][axis]));
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline std::string as_off(const Triangles& shape) {
  std::ostringstream out;
  out << "OFF\n" << shape.vertices.size() << ' ' << shape.corners.size() << " 0\n";
  for (const Point& p : shape.vertices) out << text(p) << '\n';
  for (const auto& [a, b, c] : shape.corners) out << "3 " << a << ' ' << b << ' ' << c << '\n';
  return out.str();
}

inline std::string as_stl(const Triangles& shape) {
  std::ostringstream out;
  out << "solid room\n";
  for (const auto& triangle : shape.corners) {
    out << "facet normal 0 0 0\n outer loop\n";
    for (const std::uint32_t corner : triangle) out << "  vertex " << text(shape.vertices[corner]) << '\n';
    out << " endloop\nendfacet\n";
  }
  out << "endsolid room\n";
  return out.str();
}

inline std::string as_collada(const Triangles& shape) {
  std::ostringstream out;
  out << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">)"
      << R"(<asset><unit name="centimetre" meter="0.01"/><up_axis>Z_UP</up_axis></asset>)"
      << R"(<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>)"
      << R"(<diffuse><color>0.5 0.5 0.5 1</color></diffuse></lambert></technique></profile_COMMON></effect>)"
      << R"(</library_effects><library_materials><material id="wall" name="wall"><instance_effect url="#e"/></material>)"
      << R"(</library_materials><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count=")"
      << 3 * shape.vertices.size() << "\">";
  for (const Point& p : shape.vertices) out << text(100 * p) << ' ';
  out << R"(</float_array><technique_common><accessor source="#a" stride="3" count=")" << shape.vertices.size()
      << R"("><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>)"
      << R"(</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>)"
      << R"(<triangles material="m" count=")" << shape.corners.size()
      << R"("><input semantic="VERTEX" source="#v" offset="0"/><p>)";
  for (const auto& [a, b, c] : shape.corners) out << a << ' ' << b << ' ' << c << ' ';
  out << R"(</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">)"
      << R"(<node id="n"><instance_geometry url="#g"><bind_material><technique_common>)"
      << R"(<instance_material symbol="m" target="#wall"/></technique_common></bind_material></instance_geometry>)"
      << R"(</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  return out.str();
}

/// In millimeters, the usual unit of CAD programs. One wall has a color of 0.5.
inline std::string as_ifc(const Triangles& shape) {
  std::ostringstream out;
  out << "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
         "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
         "#1=IFCCARTESIANPOINT((0.,0.,0.));\n#2=IFCAXIS2PLACEMENT3D(#1,$,$);\n#3=IFCLOCALPLACEMENT($,#2);\n"
         "#4=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#2,$);\n#5=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);"
         "\n"
         "#6=IFCUNITASSIGNMENT((#5));\n#7=IFCPROJECT('project',#21,'p',$,$,$,$,(#4),#6);\n"
         "#8=IFCSITE('site',#21,'s',$,$,#3,$,$,.ELEMENT.,$,$,$,$,$);\n#9=IFCRELAGGREGATES('a',#21,$,$,#7,(#8));\n"
         "#10=IFCPRODUCTDEFINITIONSHAPE($,$,(#11));\n#11=IFCSHAPEREPRESENTATION(#4,'Body','Brep',(#12));\n"
         "#12=IFCFACETEDBREP(#13);\n"
         "#14=IFCBUILDINGELEMENTPROXY('room',#21,'room',$,$,#3,#10,$,$);\n"
         "#15=IFCRELCONTAINEDINSPATIALSTRUCTURE('c',#21,$,$,(#14),#8);\n"
         "#16=IFCCOLOURRGB($,0.5,0.5,0.5);\n#17=IFCSURFACESTYLERENDERING(#16,0.,$,$,$,$,$,$,.FLAT.);\n"
         "#18=IFCSURFACESTYLE('wall',.BOTH.,(#17));\n#19=IFCPRESENTATIONSTYLEASSIGNMENT((#18));\n"
         "#20=IFCSTYLEDITEM(#12,(#19),$);\n"
         "#21=IFCOWNERHISTORY(#22,#25,$,.ADDED.,$,$,$,0);\n#22=IFCPERSONANDORGANIZATION(#23,#24,$);\n"
         "#23=IFCPERSON($,'','',$,$,$,$,$);\n#24=IFCORGANIZATION($,'',$,$,$);\n"
         "#25=IFCAPPLICATION(#24,'1','test','test');\n";
  std::size_t next = 100;
  const std::size_t first_vertex = next;
  for (const Point& p : shape.vertices) {
    std::ostringstream numbers;
    numbers << std::fixed;
    numbers.precision(6);
    numbers << 1000 * p.x() << ',' << 1000 * p.y() << ',' << 1000 * p.z();
    out << '#' << next++ << "=IFCCARTESIANPOINT((" << numbers.str() << "));\n";
  }
  std::string faces;
  for (const auto& [a, b, c] : shape.corners) {
    out << '#' << next << "=IFCPOLYLOOP((#" << first_vertex + a << ",#" << first_vertex + b << ",#" << first_vertex + c
        << "));\n#" << next + 1 << "=IFCFACEOUTERBOUND(#" << next << ",.T.);\n#" << next + 2 << "=IFCFACE((#"
        << next + 1 << "));\n";
    faces += (faces.empty() ? "#" : ",#") + std::to_string(next + 2);
    next += 3;
  }
  out << "#13=IFCCLOSEDSHELL((" << faces << "));\nENDSEC;\nEND-ISO-10303-21;\n";
  return out.str();
}

/// Positions are floats, followed by 16-bit indices.
inline std::string gltf_buffer(const Triangles& shape) {
  std::string bytes;
  const auto append = [&](const auto& value) { bytes += bytes_of(value); };
  for (const Point& p : shape.vertices) {
    for (int axis = 0; axis < 3; ++axis) append(static_cast<float>(p[axis]));
  }
  for (const auto& triangle : shape.corners) {
    for (const std::uint32_t corner : triangle) append(static_cast<std::uint16_t>(corner));
  }
  return bytes;
}

/// The JSON of a glTF file with one mesh. `buffer` is `"uri": "room.bin",` or empty for GLB. `node` and `material` hold
/// further properties of the node and its material.
inline std::string gltf_json(const Triangles& shape, const std::string& buffer, const std::string& node,
                             const std::string& material) {
  const std::size_t vertices = shape.vertices.size();
  const std::size_t indices = 3 * shape.corners.size();
  std::ostringstream out;
  out << R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"name": "room", "mesh": 0)"
      << node << R"(}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}], )"
      << R"("materials": [{"name": "wall", )" << material << R"(}], "buffers": [{)" << buffer << R"("byteLength": )"
      << 12 * vertices + 2 * indices << R"(}], "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": )"
      << 12 * vertices << R"(}, {"buffer": 0, "byteOffset": )" << 12 * vertices << R"(, "byteLength": )" << 2 * indices
      << R"(}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": )" << vertices
      << R"(, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": )" << indices
      << R"(, "type": "SCALAR"}]})";
  return out.str();
}

/// A GLB file: header, JSON chunk, binary chunk.
inline std::string as_glb(const Triangles& shape, const std::string& node, const std::string& material) {
  std::string json = gltf_json(shape, "", node, material);
  std::string binary = gltf_buffer(shape);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  const auto append = [&](std::size_t value) { bytes += bytes_of(static_cast<std::uint32_t>(value)); };
  append(2);
  append(28 + json.size() + binary.size());
  append(json.size());
  bytes += "JSON" + json;
  append(binary.size());
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

}  // namespace patchlight::test
