// Mirrors in model files.
#include "patchlight/input/read_scene.h"

#include "input/materials.h"
#include "model_files.h"
#include "room_files.h"
#include "support/diagnostics_of.h"

#include <gtest/gtest.h>
#include <string>
#include <utility>
#include <vector>

namespace patchlight::stated_mirrors_test {
namespace {

constexpr const char* polished = "Kd 0 0 0\nKs 0.9 0.8 0.7\nillum 3\n";
constexpr const char* smooth_metal =
    R"("pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1], "roughnessFactor": 0})";

ReadOptions settings(const std::vector<std::string>& texts) {
  ReadOptions options;
  for (const std::string& text : texts) options.settings.push_back(parse_material_setting(text));
  return options;
}

// A floor with the materials "wall" and "mirror". Each test defines the second one.
class StatedMirrors : public ModelFiles {
 protected:
  Scene of_mtl(const std::string& mirror, const ReadOptions& options = {}) const {
    write("m.mtl", "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl mirror\n" + mirror);
    return read_scene(write("m.obj",
                            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                            "usemtl wall\nf 1 2 3\nusemtl mirror\nf 1 3 4\n"),
                      options);
  }
  Material mirror_of(const std::string& statements, const ReadOptions& options = {}) const {
    return of_mtl(statements, options).materials[1];
  }
  Scene of_gltf(const std::string& material, const ReadOptions& options = {}) const {
    return read_scene(write("room.glb", test::as_glb(test::room(), "", material)), options);
  }
};

void expect_mirror(const Material& material, const Spectrum& specular, const Spectrum& diffuse) {
  ASSERT_EQ(material.specular_reflectance.size(), specular.size());
  EXPECT_TRUE((material.specular_reflectance == specular).all()) << material.specular_reflectance;
  EXPECT_TRUE((material.reflectance == diffuse).all()) << material.reflectance;
}

void expect_matt(const Material& material) {
  EXPECT_FALSE((material.specular_reflectance > 0).any()) << material.specular_reflectance;
  EXPECT_FALSE(material.stated_mirror);
}

TEST_F(StatedMirrors, AreSmoothWithAnIlluminationThatReflects) {
  for (const char* smooth : {"illum 3\n", "illum 5\n", "illum 8\n", "illum 3\nNs 1000\n", "illum 3\nNs 900\n",
                             "illum 3\nPr 0.05\n", "illum 3\nPm 0.5\n"}) {
    SCOPED_TRACE(smooth);
    const Scene scene = of_mtl("Kd 0.1 0.1 0.1\nKs 0.9 0.8 0.7\n" + std::string(smooth));
    expect_mirror(scene.materials[1], rgb(0.9, 0.8, 0.7), rgb(0.1, 0.1, 0.1));
    expect_matt(scene.materials[0]);
    EXPECT_TRUE(scene.unsimulated.empty());
    EXPECT_EQ(test::codes_of(test::notes_of(scene)), std::vector{DiagnosticCode::read_as_mirror});
  }
}

TEST_F(StatedMirrors, WhatIsRoughOrHasNoReflectionIsGloss) {
  for (const char* statements :
       {"Ks 0.9 0.9 0.9\n", "Ks 0.9 0.9 0.9\nillum 2\n", "Ks 0.9 0.9 0.9\nillum 4\n", "Ks 0 0 0\nillum 3\n",
        "illum 3\n", "Ks 0.5 0.5 0.5\nNs 250\nillum 3\n", "Ks 0.5 0.5 0.5\nNs 899\nillum 3\n",
        "Ks 0.5 0.5 0.5\nPr 0.06\nillum 3\n", "Ks 0.5 0.5 0.5\nmap_Ks worn.png\nillum 3\n",
        "Kd 1 1 1\nKs 0.5 0.5 0.5\nillum 3\n", "Kd 0 0 0\nKs 0.5 0.5 0.5\nPm 1\nillum 3\n"}) {
    SCOPED_TRACE(statements);
    const Scene scene = of_mtl(statements);
    expect_matt(scene.materials[1]);
    EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::read_as_mirror));
    ASSERT_EQ(scene.unsimulated.size(), 1U);
    EXPECT_EQ(scene.unsimulated[0].property, UnsimulatedProperty::mirror);
  }
}

// Where rho + rho_s <= 1 to rounding, nothing is reduced: 1 - 0.9 is slightly less than 0.1.
TEST_F(StatedMirrors, ReflectNoMoreThanTheyDoNotScatter) {
  const Scene scene = of_mtl("Kd 0.5 0.3 0\nKs 0.9 0.5 1.5\nillum 3\n");
  expect_mirror(scene.materials[1], rgb(0.5, 0.5, 1), rgb(0.5, 0.3, 0));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::lowered_reflectance, {"mirror"}));
  EXPECT_FALSE(
      has(of_mtl("Kd 0.9 0.9 0.9\nKs 0.1 0.1 0.1\nillum 3\n").diagnostics, DiagnosticCode::lowered_reflectance));
  expect_mirror(mirror_of(polished, settings({"mirror.reflectance=0.2"})), rgb(1 - 0.2, 1 - 0.2, 0.7),
                rgb(0.2, 0.2, 0.2));
}

TEST_F(StatedMirrors, AMetalReflectsItsColor) {
  expect_mirror(mirror_of("Kd 0.9 0.6 0.3\nKs 0.5 0.5 0.5\nPm 1\nillum 3\n"), rgb(0.9, 0.6, 0.3), rgb(0, 0, 0));
}

TEST_F(StatedMirrors, ASmoothMetalOfGltfReflectsItsBaseColor) {
  const Scene scene = of_gltf(smooth_metal);
  expect_mirror(scene.materials[0], rgb(0.9, 0.6, 0.3), rgb(0, 0, 0));
  EXPECT_TRUE(scene.unsimulated.empty());
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::read_as_mirror,
                  {"wall (", "0.9, 0.6, 0.3", "read.settings wall.specular_reflectance=0"}));
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::simplified_part));
}

TEST_F(StatedMirrors, OtherMetalsOfGltfAreMatt) {
  for (const char* factors :
       {R"("metallicFactor": 1)", R"("roughnessFactor": 0.06)", R"("metallicFactor": 0.8, "roughnessFactor": 0)",
        R"("roughnessFactor": 0, "metallicRoughnessTexture": {"index": 0})"}) {
    SCOPED_TRACE(factors);
    const Scene scene =
        of_gltf(R"("pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.6, 0.3, 1], )" + std::string(factors) + "}");
    expect_matt(scene.materials[0]);
    EXPECT_TRUE((scene.materials[0].reflectance == rgb(0.9, 0.6, 0.3)).all());
    EXPECT_EQ(scene.unsimulated.size(), 1U);
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"metallic", "wall"}));
  }
}

TEST_F(StatedMirrors, PanesAreNone) {
  for (const Material& pane : {mirror_of(std::string(polished) + "d 0.3\n"),
                               of_gltf(std::string(smooth_metal) +
                                       R"(, "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}})")
                                   .materials[0]}) {
    expect_matt(pane);
    EXPECT_TRUE((pane.transmittance > 0).any());
  }
}

// The note names the setting that gives the result for a rough surface.
TEST_F(StatedMirrors, ASettingMakesThemMatt) {
  const ReadOptions matt = settings({"*.specular_reflectance=0"});
  const std::string metal = "Kd 0.9 0.6 0.3\nKs 0.5 0.5 0.5\nPm 1\nillum 3\n";
  for (const auto& [found, expected] :
       std::vector<std::pair<Material, Spectrum>>{{mirror_of(polished, matt), rgb(0, 0, 0)},
                                                  {mirror_of(metal, matt), rgb(0.9, 0.6, 0.3)},
                                                  {of_gltf(smooth_metal, matt).materials[0], rgb(0.9, 0.6, 0.3)}}) {
    expect_matt(found);
    EXPECT_TRUE((found.reflectance == expected).all()) << found.reflectance;
  }
  EXPECT_FALSE(has(of_mtl(polished, matt).diagnostics, DiagnosticCode::read_as_mirror));
  EXPECT_TRUE(has(of_mtl(polished).diagnostics, DiagnosticCode::read_as_mirror,
                  {"mirror (illum 3", "0.9, 0.8, 0.7", "read.settings mirror.specular_reflectance=0"}));
}

TEST_F(StatedMirrors, AreThoseThatASettingMakes) {
  const Material stated = mirror_of(polished);
  const Material set = mirror_of("Kd 0 0 0\n", settings({"mirror.specular_reflectance=0.9,0.8,0.7"}));
  expect_mirror(stated, set.specular_reflectance, set.reflectance);
}

// A pane is never a mirror, even if the file declares one.
TEST_F(StatedMirrors, ASettingCountsMoreThanTheFile) {
  expect_mirror(mirror_of(polished, settings({"mirror.specular_reflectance=0.5"})), rgb(0.5, 0.5, 0.5), rgb(0, 0, 0));
  const Material pane = of_gltf(smooth_metal, settings({"wall.transmittance=0.1"})).materials[0];
  expect_matt(pane);
  EXPECT_TRUE((pane.transmittance == 0.1).all());
  EXPECT_TRUE((pane.reflectance == rgb(0.9, 0.6, 0.3)).all());
  const Material mirror = mirror_of("Kd 0.1 0.1 0.1\nd 0.3\n", settings({"mirror.specular_reflectance=0.9"}));
  expect_mirror(mirror, rgb(0.9, 0.9, 0.9), rgb(0.1, 0.1, 0.1));
  EXPECT_FALSE((mirror.transmittance > 0).any());
  EXPECT_THROW(of_mtl(polished, settings({"mirror.specular_reflectance=0.9", "mirror.reflectance=0.2"})), InputError);
}

TEST_F(StatedMirrors, BadNumbersAreRefusedNamingTheLine) {
  for (const char* statement : {"Ks 0.9", "Ks a b c", "Ns nan", "Pr", "Pm x"}) {
    write("m.mtl", std::string("newmtl mirror\n") + statement + "\n");
    const std::string message =
        refusal(write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl mirror\nf 1 2 3\n"));
    EXPECT_NE(message.find("m.mtl:2: "), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace patchlight::stated_mirrors_test
