#include "patchlight/input/read_scene.h"

#include "model_files.h"
#include "room_files.h"

#include <array>
#include <cmath>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

namespace patchlight::gltf_compression_test {
namespace {

// A room of 3 x 2.4 x 2.1 m. The libraries that unpack its parts also pack them here.
class GltfCompression : public ModelFiles {
 protected:
  static std::string glb(std::string json, std::string binary) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    const auto number = [](std::size_t value) { return test::bytes_of(static_cast<std::uint32_t>(value)); };
    return "glTF" + number(2) + number(28 + json.size() + binary.size()) + number(json.size()) + "JSON" + json +
           number(binary.size()) + std::string("BIN\0", 4) + binary;
  }

  static std::string text_of(const std::vector<unsigned char>& bytes) { return {bytes.begin(), bytes.end()}; }

  static std::string model(const std::string& extension, const std::string& primitive, const std::string& rest) {
    return R"({"asset": {"version": "2.0"}, "extensionsUsed": [")" + extension + R"("], "extensionsRequired": [")" +
           extension +
           R"("], "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "materials": [{"name": "wall"}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0)" +
           primitive + "}]}], " + rest + "}";
  }

  static std::string count(std::size_t number) { return std::to_string(number); }
};

const test::Triangles& room() {
  static const test::Triangles triangles = test::room();
  return triangles;
}

// Area and volume, whether or not coplanar triangles are joined.
void expect_room(const Scene& scene) {
  double area = 0;
  double volume = 0;
  for (PolygonIndex p = 0; p < scene.polygons.size(); ++p) {
    const std::vector<Point> corners = corner_points(scene, p);
    area += area_vector(corners).norm();
    volume += corners[0].dot(area_vector(corners)) / 3;
  }
  double expected_area = 0;
  double expected_volume = 0;
  for (const auto& [a, b, c] : room().corners) {
    const Point& first = room().vertices[a];
    const Vector twice = (room().vertices[b] - first).cross(room().vertices[c] - first);
    expected_area += twice.norm() / 2;
    expected_volume += first.dot(twice) / 6;
  }
  // Single precision.
  EXPECT_NEAR(area, expected_area, 1e-5 * expected_area);
  EXPECT_NEAR(volume, expected_volume, 1e-5 * std::abs(expected_volume));
}

std::vector<std::uint32_t> indices_of(const test::Triangles& shape) {
  std::vector<std::uint32_t> indices;
  for (const auto& triangle : shape.corners) indices.insert(indices.end(), triangle.begin(), triangle.end());
  return indices;
}

TEST_F(GltfCompression, ViewsOfMeshoptAreUnpacked) {
  std::vector<float> positions;
  for (const Point& point : room().vertices)
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(point[axis]));
  const std::size_t vertices = room().vertices.size();
  const std::vector<std::uint32_t> indices = indices_of(room());
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(vertices, 12));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), positions.data(), vertices, 12));
  std::vector<unsigned char> corners(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  corners.resize(meshopt_encodeIndexBuffer(corners.data(), corners.size(), indices.data(), indices.size()));
  const auto view = [](std::size_t offset, std::size_t length, std::size_t stride, std::size_t number,
                       const std::string& mode) {
    return R"({"buffer": 1, "byteLength": )" + count(stride * number) +
           R"(, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteOffset": )" + count(offset) +
           R"(, "byteLength": )" + count(length) + R"(, "byteStride": )" + count(stride) + R"(, "count": )" +
           count(number) + R"(, "mode": ")" + mode + "\"}}}";
  };
  const auto file = [&](std::size_t cut) {
    return glb(model("EXT_meshopt_compression", "",
                     R"("buffers": [{"byteLength": )" + count(packed.size() + corners.size()) +
                         R"(}, {"byteLength": 100000, "extensions": {"EXT_meshopt_compression": {"fallback": true}}}],
      "bufferViews": [)" +
                         view(0, packed.size() - cut, 12, vertices, "ATTRIBUTES") + ", " +
                         view(packed.size(), corners.size(), 4, indices.size(), "TRIANGLES") +
                         R"(], "accessors": [{"bufferView": 0, "componentType": 5126, "count": )" + count(vertices) +
                         R"(, "type": "VEC3"}, {"bufferView": 1, "componentType": 5125, "count": )" +
                         count(indices.size()) + R"(, "type": "SCALAR"}])"),
               text_of(packed) + text_of(corners));
  };
  expect_room(read_scene(write("room.glb", file(0))));
  EXPECT_NE(refusal(write("cut.glb", file(5))).find("buffer view 0 "), std::string::npos);
}

TEST_F(GltfCompression, MeshesOfDracoAreUnpacked) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(room().corners.size()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t f = 0; f < room().corners.size(); ++f) {
    std::array<std::array<float, 3>, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        corner[k][axis] = static_cast<float>(room().vertices[room().corners[f][k]][static_cast<Eigen::Index>(axis)]);
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(static_cast<std::uint32_t>(f)), corner[0].data(),
                                      corner[1].data(), corner[2].data());
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::EncoderBuffer packed;
  draco::Encoder encoder;
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &packed).ok());
  const auto file = [&](std::size_t size) {
    return glb(
        model("KHR_draco_mesh_compression",
              R"(, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}})",
              R"("buffers": [{"byteLength": )" + count(packed.size()) +
                  R"(}], "bufferViews": [{"buffer": 0, "byteLength": )" + count(size) +
                  R"(}], "accessors": [{"componentType": 5126, "count": )" + count(mesh->num_points()) +
                  R"(, "type": "VEC3"}, {"componentType": 5125, "count": )" + count(3 * room().corners.size()) +
                  R"(, "type": "SCALAR"}])"),
        std::string(packed.data(), packed.size()));
  };
  expect_room(read_scene(write("room.glb", file(packed.size()))));
  EXPECT_NE(refusal(write("cut.glb", file(packed.size() / 2))).find("mesh 0 "), std::string::npos);
}

}  // namespace
}  // namespace patchlight::gltf_compression_test
