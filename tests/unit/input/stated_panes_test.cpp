// Transparency in model files.
#include "patchlight/input/read_scene.h"

#include "input/materials.h"
#include "light/pane.h"
#include "model_files.h"
#include "room_files.h"

#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::stated_panes_test {
namespace {

ReadOptions settings(const std::vector<std::string>& texts) {
  ReadOptions options;
  for (const std::string& text : texts) options.settings.push_back(parse_material_setting(text));
  return options;
}

// A floor with the materials "wall" and "glass", defined by each test.
class StatedPanes : public ModelFiles {
 protected:
  Scene of_mtl(const std::string& glass, const std::string& wall = "Kd 0.5 0.5 0.5\n",
               const ReadOptions& options = {}) {
    write("m.mtl", "newmtl wall\n" + wall + "newmtl glass\nKd 0.1 0.1 0.1\n" + glass);
    return read_scene(write("m.obj",
                            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                            "usemtl wall\nf 1 2 3\nusemtl glass\nf 1 3 4\n"),
                      options);
  }
  Material glass_of(const std::string& statements, const ReadOptions& options = {}) {
    return of_mtl(statements, "Kd 0.5 0.5 0.5\n", options).materials[1];
  }
  Scene of_gltf(const std::string& material, const ReadOptions& options = {}) const {
    return read_scene(write("room.glb", test::as_glb(test::room(), "", material)), options);
  }
  Scene of_collada(const std::string& transparency, const ReadOptions& options = {}) const {
    std::string text = test::as_collada(test::room());
    const std::string before = "</diffuse>";
    text.insert(text.find(before) + before.size(), transparency);
    return read_scene(write("room.dae", text), options);
  }
  Scene of_ifc(const std::string& transparency, const ReadOptions& options = {}) const {
    std::string text = test::as_ifc(test::room());
    const std::string opaque = "RENDERING(#16,0.,";
    text.replace(text.find(opaque), opaque.size(), "RENDERING(#16," + transparency + ",");
    return read_scene(write("room.ifc", text), options);
  }
};

void expect_transmittance(const Material& material, const Spectrum& expected) {
  ASSERT_EQ(material.transmittance.size(), expected.size());
  EXPECT_LT((material.transmittance - expected).abs().maxCoeff(), 1e-7) << material.transmittance;
}

void expect_opaque(const Material& material) {
  EXPECT_FALSE((material.transmittance > 0).any()) << material.transmittance;
  EXPECT_FALSE(material.stated_pane);
}

constexpr const char* base_color = R"("pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 0.25]})";

std::string transmitting(const std::string& factor, const std::string& ior = "") {
  return std::string(base_color) + R"(, "extensions": {"KHR_materials_transmission": {"transmissionFactor": )" +
         factor + "}" + (ior.empty() ? "" : R"(, "KHR_materials_ior": {"ior": )" + ior + "}") + "}";
}

const std::string collada_glass =
    "<transparent opaque=\"A_ONE\"><color>1 1 1 1</color></transparent>"
    "<transparency><float>0.25</float></transparency>";

TEST_F(StatedPanes, DissolveIsTheShareThatIsNotLetThrough) {
  for (const auto& [statements, expected] :
       std::vector<std::pair<std::string, Spectrum>>{{"d 0.3\n", rgb(0.7, 0.7, 0.7)},
                                                     {"d -halo 0.3\n", rgb(0.7, 0.7, 0.7)},
                                                     {"Tr 0.7\n", rgb(0.7, 0.7, 0.7)},
                                                     {"Tr 0.7\nd 0.3\n", rgb(0.7, 0.7, 0.7)},
                                                     {"d 0.3\nTr 0.3\n", rgb(0.7, 0.7, 0.7)},
                                                     {"d 0.3\nTf 1 1 1\nillum 2\n", rgb(0.7, 0.7, 0.7)},
                                                     {"d 0.3\nTf 0 0 0\n", rgb(0.7, 0.7, 0.7)},
                                                     {"d 0.5\nTf 1 0.5 0.25\n", rgb(0.5, 0.25, 0.125)},
                                                     {"Tf 0.9 0.5 0.2\nillum 7\n", rgb(0.9, 0.5, 0.2)}}) {
    SCOPED_TRACE(statements);
    expect_transmittance(glass_of(statements), expected);
  }
}

TEST_F(StatedPanes, WhatProgramsWriteOfOpaqueMaterialsIsNone) {
  for (const char* statements :
       {"d 1\n", "Tr 0\n", "d 1\nTr 0\n", "d 1\nTr 1\n", "d 0\nTr 0\n", "d 1\nTf 1 1 1\nillum 2\n",
        "Tf 1 1 1\nillum 4\n", "Tf 0.5 0.5 0.5\nillum 2\n", "Tf 0 0 0\nillum 7\n", "d 1\nTf 0.5 0.5 0.5\nillum 7\n"}) {
    SCOPED_TRACE(statements);
    expect_opaque(glass_of(statements));
  }
  EXPECT_TRUE(has(of_mtl("d 1\nTr 1\n").diagnostics, DiagnosticCode::simplified_part, {"d and Tr", "glass"}));
}

TEST_F(StatedPanes, WhereMostMaterialsLetAllThroughTheyAreOpaque) {
  for (const char* all : {"d 0\n", "Tr 1\n"}) {
    const Scene scene = of_mtl(all, all);
    for (const Material& material : scene.materials) expect_opaque(material);
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::assumed_material,
                    {"wall, glass", "read.settings wall.transmittance=1"}));
  }
  // One of two is used.
  expect_transmittance(of_mtl("d 0\n").materials[1], rgb(1, 1, 1));
}

TEST_F(StatedPanes, TheIndexIsThatOfTheFileIfItIsPlausible) {
  EXPECT_EQ(glass_of("d 0.3\nNi 1.45\n").index, 1.45);
  for (const char* unknown : {"d 0.3\n", "d 0.3\nNi 1\n", "d 0.3\nNi 0\n", "d 0.3\nNi 10\n", "d 1\nNi 1.45\n"})
    EXPECT_EQ(glass_of(unknown).index, usual_index) << unknown;
  EXPECT_EQ(of_gltf(transmitting("0.5", "1.33")).materials[0].index, 1.33);
  for (const char* unknown : {"", "0", "1"})
    EXPECT_EQ(of_gltf(transmitting("0.5", unknown)).materials[0].index, 1.5) << unknown;
}

TEST_F(StatedPanes, BadNumbersAreRefusedNamingTheLine) {
  for (const char* statement : {"d", "d nan", "Tr clear", "Ni x", "Tf 0.5"}) {
    write("m.mtl", std::string("newmtl glass\n") + statement + "\n");
    const std::string message =
        refusal(write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl glass\nf 1 2 3\n"));
    EXPECT_NE(message.find("m.mtl:2: "), std::string::npos) << message;
  }
}

TEST_F(StatedPanes, GltfTransmitsBaseColor) {
  const Scene scene = of_gltf(transmitting("0.8"));
  expect_transmittance(scene.materials[0], rgb(0.72, 0.48, 0.24));
  EXPECT_TRUE(scene.materials[0].reflectance.isApprox(rgb(0.18, 0.12, 0.06), 1e-12)) << "what is not transmitted";
}

// The pane transmits no more than one of its index that absorbs nothing: pane_of() keeps the index.
TEST_F(StatedPanes, GltfLetsNoMoreThroughThanGlassOfItsIndex) {
  const std::string white = R"("extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}})";
  const Material material = of_gltf(white).materials[0];
  EXPECT_NEAR(material.transmittance[0], 12.0 / 13, 1e-15);
  const Pane pane = pane_of(material.index, material.transmittance[0]);
  EXPECT_NEAR(pane.index, 1.5, 1e-7);
  EXPECT_NEAR(pane.internal, 1, 1e-12);
}

TEST_F(StatedPanes, GltfAlphaIsWhatIsCovered) {
  const Scene blended = of_gltf(std::string(base_color) + R"(, "alphaMode": "BLEND")");
  expect_transmittance(blended.materials[0], rgb(0.75, 0.75, 0.75));
  EXPECT_TRUE(blended.materials[0].reflectance.isApprox(rgb(0.225, 0.15, 0.075), 1e-12));
  // A quarter is covered, of which 0.8 times the base color is transmitted.
  const Scene both = of_gltf(transmitting("0.8") + R"(, "alphaMode": "BLEND")");
  expect_transmittance(both.materials[0], rgb(0.93, 0.87, 0.81));
  for (const char* mode : {R"(, "alphaMode": "MASK")", R"(, "alphaMode": "OPAQUE")", ""})
    expect_opaque(of_gltf(base_color + std::string(mode)).materials[0]);
  const Scene masked = of_gltf(std::string(base_color) + R"(, "alphaMode": "MASK")");
  EXPECT_TRUE(has(masked.diagnostics, DiagnosticCode::simplified_part, {"masks", "wall"}));
  ASSERT_EQ(masked.unsimulated.size(), 2U) << "metal, mask";
}

TEST_F(StatedPanes, ColladaAndIfcStateOpacity) {
  expect_transmittance(of_ifc("0.9").materials[0], rgb(0.9, 0.9, 0.9));
  expect_transmittance(of_collada(collada_glass).materials[0], rgb(0.75, 0.75, 0.75));
  const auto zero = [](const std::string& color) {
    return "<transparent opaque=\"RGB_ZERO\"><color>" + color +
           " 1</color></transparent><transparency><float>0.5</float></transparency>";
  };
  expect_transmittance(of_collada(zero("0.8 0.8 0.8")).materials[0], rgb(0.4, 0.4, 0.4));
  expect_transmittance(of_collada(zero("0.8 0.4 0.2")).materials[0], rgb(0.4, 0.2, 0.1));
  EXPECT_EQ(of_collada(collada_glass).materials[0].index, usual_index);
  EXPECT_EQ(
      of_collada(collada_glass + "<index_of_refraction><float>1.4</float></index_of_refraction>").materials[0].index,
      static_cast<double>(1.4F));
  expect_opaque(of_ifc("0.").materials[0]);
  expect_opaque(of_collada("").materials[0]);
}

// The note names them and the setting that gives the result without transparency.
TEST_F(StatedPanes, ASettingMakesThemOpaque) {
  const ReadOptions opaque = settings({"*.transmittance=0"});
  const std::string grey = R"("pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1]})";
  const std::vector<std::pair<Scene, Scene>> pairs = {
      {of_mtl("d 0.05\n", "Kd 0.5 0.5 0.5\n", opaque), of_mtl("")},
      {of_gltf(transmitting("0.8"), opaque), of_gltf(grey)},
      {of_gltf(std::string(base_color) + R"(, "alphaMode": "BLEND")", opaque), of_gltf(grey)},
      {of_collada(collada_glass, opaque), of_collada("")},
      {of_ifc("0.9", opaque), of_ifc("0.")}};
  for (const auto& [found, expected] : pairs) {
    ASSERT_EQ(found.materials.size(), expected.materials.size());
    for (std::size_t m = 0; m < found.materials.size(); ++m) {
      EXPECT_TRUE((found.materials[m].reflectance == expected.materials[m].reflectance).all());
      expect_opaque(found.materials[m]);
    }
    EXPECT_EQ(texts_of(found.diagnostics), texts_of(expected.diagnostics));
  }
  EXPECT_TRUE(has(of_mtl("d 0.3\n").diagnostics, DiagnosticCode::read_as_pane,
                  {"glass (d 0.3: transmittance 0.7)", "read.settings glass.transmittance=0"}));
}

TEST_F(StatedPanes, AreThoseThatASettingMakes) {
  const Material stated = glass_of("d 0.2\n");
  const Material set = glass_of("", settings({"glass.transmittance=0.8"}));
  expect_transmittance(stated, set.transmittance);
  EXPECT_TRUE((stated.reflectance == set.reflectance).all());
  EXPECT_EQ(stated.index, set.index);
}

TEST_F(StatedPanes, ASettingCountsMoreThanTheFile) {
  const Material material = glass_of("d 0.9\nNi 1.4\n", settings({"glass.transmittance=0.8", "glass.index=1.6"}));
  expect_transmittance(material, rgb(0.8, 0.8, 0.8));
  EXPECT_EQ(material.index, 1.6);
  EXPECT_FALSE(material.stated_pane);
  EXPECT_EQ(glass_of("d 0.9\n", settings({"glass.index=1.6"})).index, 1.6);
}

// rho + T <= 1 for any rho in the file and the settings.
TEST_F(StatedPanes, ReflectNoMoreThanTheyDoNotLetThrough) {
  const Scene scene = of_mtl("d 0.3\nTf 1 0.5 0.1\n", "Kd 0.5 0.5 0.5\n", settings({"*.reflectance=0.6"}));
  EXPECT_TRUE((scene.materials[1].reflectance == (1 - scene.materials[1].transmittance).min(0.6)).all());
  EXPECT_TRUE((scene.materials[0].reflectance == 0.6).all());
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::lowered_reflectance, {"glass"}));
  EXPECT_FALSE(has(of_mtl("d 0.3\n").diagnostics, DiagnosticCode::lowered_reflectance));
  const Material restored = glass_of("d 0.3\n", settings({"glass.reflectance=0.6", "glass.transmittance=0"}));
  EXPECT_TRUE((restored.reflectance == 0.6).all());
}

TEST_F(StatedPanes, AnIndexAloneIsRefused) {
  of_mtl("");
  for (const char* setting : {"glass.index=1.6", "*.index=1.6"}) {
    const std::string message = refusal(folder_ / "m.obj", settings({setting}));
    EXPECT_TRUE(message.starts_with("read.settings: ")) << message;
    EXPECT_NE(message.find("1.6"), std::string::npos) << message;
    EXPECT_NE(message.find(".transmittance=0.8"), std::string::npos) << message;
  }
  const std::string model = "[[model]]\nfile = \"m.obj\"\n[[material]]\nname = \"glass\"\nindex = 1.6\n";
  const std::string message = refusal(write("m.toml", model));
  for (const char* word : {"m.toml:4: ", "1.6", "'glass'"}) EXPECT_NE(message.find(word), std::string::npos) << message;
  // In any order, and a transmittance of 0 resets an earlier one.
  EXPECT_EQ(glass_of("", settings({"glass.index=1.6", "glass.transmittance=0.8"})).index, 1.6);
  EXPECT_NO_THROW(read_scene(write("m.toml", model + "transmittance = 0.8\n"), settings({"glass.transmittance=0"})));
}

// The same for a scene that was read before.
TEST_F(StatedPanes, NothingReflectsWhatItLetsThrough) {
  const ReadOptions both = settings({"wall.transmittance=0.6", "wall.reflectance=0.5"});
  const Scene scene = of_mtl("");
  EXPECT_THROW(read_scene(folder_ / "m.obj", both), InputError);
  EXPECT_THROW(with_options(scene, both), InputError);
}

TEST_F(StatedPanes, PatternsDoNotMeanSecondFaces) {
  Scene scene = of_mtl("d 0.3\n");
  scene.materials.push_back({"glass (second face)", rgb(0, 0, 0), rgb(0, 0, 0), rgb(1, 1, 1)});
  scene.materials.back().second_face = true;
  scene = with_options(std::move(scene), settings({"*.reflectance=0.2", "gl*.exitance=1"}));
  EXPECT_TRUE((scene.materials[1].reflectance == 0.2).all());
  EXPECT_TRUE((scene.materials[1].exitance == 1).all());
  EXPECT_TRUE((scene.materials[2].reflectance == 0).all());
  EXPECT_TRUE((scene.materials[2].exitance == 0).all());
}

}  // namespace
}  // namespace patchlight::stated_panes_test
