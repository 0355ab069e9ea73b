// Partly covered surfaces: alpha of textures in glTF, map_d in OBJ.
#include "input/picture_colours.h"
#include "light/pane.h"
#include "model_files.h"

#include <cstring>
#include <gtest/gtest.h>
#include <numbers>

namespace patchlight::masks_test {
namespace {

using Alpha = std::array<unsigned char, 4>;

// Red, red, green and blue with these alphas.
std::string four_pixels(const Alpha& alpha) {
  const std::string colours("\xFF\0\0\xFF\0\0\0\xFF\0\0\0\xFF", 12);
  std::string pixels;
  for (std::size_t k = 0; k < 4; ++k) pixels += colours.substr(3 * k, 3) + static_cast<char>(alpha[k]);
  return png_of(2, 2, pixels, 4);
}

void expect_near(const Spectrum& found, const Spectrum& expected) {
  EXPECT_TRUE(found.isApprox(expected, 1e-12) || (found - expected).abs().maxCoeff() < 1e-15)
      << found.transpose() << " instead of " << expected.transpose();
}

ReadOptions with(const std::vector<std::string>& settings) {
  ReadOptions options;
  for (const std::string& setting : settings) options.settings.push_back(parse_material_setting(setting));
  return options;
}

// A pane of holes, which transmits the same fraction at all angles and in all bands.
void expect_holes(const Material& material, double covered, const Spectrum& reflectance) {
  expect_near(material.transmittance, Spectrum::Constant(3, 1 - covered));
  expect_near(material.reflectance, reflectance);
  expect_near(transmittance(panes_of(material.index, material.transmittance), 0.1), Spectrum::Constant(3, 1 - covered));
  const Spectrum held = hemispherical_nonspecular(panes_of(material.index, material.transmittance));
  EXPECT_NEAR(held[0], covered, 1e-9);
  EXPECT_FALSE(material.texture);
}

class GltfMasks : public ModelFiles {
 protected:
  // A triangle of a material with the texture, and one of a plain material.
  Scene read(const Alpha& alpha, const std::string& mode, const std::string& factor = "[1,1,1,1]",
             const std::vector<std::string>& settings = {}) {
    return read_picture(four_pixels(alpha), mode, factor, settings);
  }
  Scene read_picture(const std::string& picture, const std::string& mode, const std::string& factor = "[1,1,1,1]",
                     const std::vector<std::string>& settings = {}) {
    const std::array<float, 9> values = {0, 0, 0, 1, 0, 0, 1, 1, 0};
    std::string bytes(sizeof values, '\0');
    std::memcpy(bytes.data(), values.data(), sizeof values);
    write("corners.bin", bytes);
    write("leaves.png", picture);
    const std::string json =
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0},{"mesh":1,"translation":[0,0,1]}],"meshes":[)"
        R"({"primitives":[{"attributes":{"POSITION":0},"material":0}]},)"
        R"({"primitives":[{"attributes":{"POSITION":0},"material":1}]}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"uri":"corners.bin","byteLength":36}],)"
        R"("images":[{"uri":"leaves.png"}],"textures":[{"source":0}],"materials":[{"name":"leaves",)" +
        mode + R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorFactor":)" + factor +
        R"(,"baseColorTexture":{"index":0}}},{"name":"floor","pbrMetallicRoughness":{"metallicFactor":0}}]})";
    return read_scene(write("leaves.gltf", json), with(settings));
  }
};

const std::string masked = R"("alphaMode":"MASK",)";
const std::string blended = R"("alphaMode":"BLEND",)";

TEST_F(GltfMasks, HalfOpaqueLetsHalfOfTheLightThrough) {
  const Scene scene = read({255, 0, 255, 0}, masked);
  expect_holes(scene.materials[0], .5, rgb(.25, .25, 0));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::cut_out_material, {"leaves (0.5)"}));
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::simplified_part));
  EXPECT_TRUE(std::none_of(scene.unsimulated.begin(), scene.unsimulated.end(), [](const UnsimulatedMaterials& found) {
    return found.property == UnsimulatedProperty::glass;
  }));
}

TEST_F(GltfMasks, TheCutoffDecidesWhichTexelsAreThere) {
  const Alpha alpha = {51, 102, 153, 204};  // 0.2, 0.4, 0.6, 0.8
  expect_holes(read(alpha, masked).materials[0], .5, rgb(0, .25, .25));
  const auto cut_off = [](const std::string& at) { return masked + R"("alphaCutoff":)" + at + ","; };
  expect_holes(read(alpha, cut_off("0.8")).materials[0], .25, rgb(0, 0, .25));
  expect_holes(read(alpha, cut_off("0.3")).materials[0], .75, rgb(.25, .25, .25));
  // The factor's alpha times that of the texels: 0.1 to 0.4.
  expect_holes(read(alpha, cut_off("0.15"), "[1,1,1,0.5]").materials[0], .75, rgb(.25, .25, .25));
}

TEST_F(GltfMasks, BlendedTexelsCoverTheirAlpha) {
  expect_holes(read({51, 102, 153, 204}, blended).materials[0], .5, rgb(.15, .15, .2));
  // Times the factor, in color and alpha.
  expect_holes(read({51, 102, 153, 204}, blended, "[1,0.5,1,0.5]").materials[0], .25, rgb(.075, .0375, .1));
}

TEST_F(GltfMasks, OpaquePicturesAndModesAreWhatTheyWere) {
  const Scene opaque = read({255, 255, 255, 255}, masked);
  EXPECT_TRUE(opaque.materials[0].texture);
  EXPECT_FALSE(opaque.materials[0].stated_pane);
  EXPECT_FALSE(has(opaque.diagnostics, DiagnosticCode::cut_out_material));
  const Scene ignored = read({255, 0, 255, 0}, "");
  EXPECT_TRUE(ignored.materials[0].texture);
  EXPECT_FALSE(has(ignored.diagnostics, DiagnosticCode::cut_out_material));
}

// Fractions of alphas, added after a division, are inexact by rounding.
TEST_F(GltfMasks, ThatAllTexelsReachAreNone) {
  std::string pixels;
  for (int k = 0; k < 11 * 13; ++k)
    for (const int code : {k * 3, 255 - k * 3, 100, 200 + k % 55}) pixels += static_cast<char>(code);
  const Scene scene = read_picture(png_of(11, 13, pixels, 4), masked);
  EXPECT_TRUE(scene.materials[0].texture);
  EXPECT_FALSE(scene.materials[0].stated_pane);
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::cut_out_material));
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::read_as_pane));
}

// White with the covered fraction m reflects m, which is 1 - (1 - m) to rounding.
TEST_F(GltfMasks, OfWhiteReflectWhatTheyCover) {
  std::string pixels(4 * 10, '\xFF');
  for (std::size_t k = 1; k < 10; ++k) pixels[4 * k + 3] = '\0';
  const Scene scene = read_picture(png_of(10, 1, pixels, 4), masked);
  expect_holes(scene.materials[0], .1, rgb(.1, .1, .1));
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::lowered_reflectance));
}

// A lamp with half coverage emits half. An opaque one emits all.
TEST_F(GltfMasks, OfLampsEmitByWhatTheyCover) {
  const std::string lamp = masked + R"("emissiveFactor":[1,0.5,0],)";
  const Alpha half = {255, 0, 255, 0};
  const auto exitance = [&](const std::vector<std::string>& settings) {
    return read(half, lamp, "[1,1,1,1]", settings).materials[0].exitance;
  };
  expect_near(exitance({}), std::numbers::pi / 2 * rgb(1, .5, 0));
  expect_near(exitance({"leaves.transmittance=0"}), std::numbers::pi * rgb(1, .5, 0));
  expect_near(exitance({"leaves.exitance=7", "leaves.transmittance=0"}), rgb(7, 7, 7));
  expect_near(exitance({"leaves.transmittance=0", "leaves.radiance=7"}), std::numbers::pi * rgb(7, 7, 7));
}

// The same after a conversion to bands of wavelengths.
TEST_F(GltfMasks, OfLampsAreThereAgainInBands) {
  read(Alpha{255, 0, 255, 0}, masked + R"("emissiveFactor":[1,1,1],)");
  const std::string bands = "[[model]]\nfile = \"leaves.gltf\"\n[spectra]\nbands = 4\n";
  const Scene scene = read_scene(write("scene.toml", bands));
  ASSERT_EQ(number_of_bands(scene), 4);
  const Scene opaque = with_options(scene, with({"leaves.transmittance=0"}));
  EXPECT_TRUE(opaque.materials[0].exitance.isApprox(2 * scene.materials[0].exitance, 1e-12))
      << opaque.materials[0].exitance.transpose();
}

class ObjMasks : public ModelFiles {
 protected:
  Scene read(const std::string& statements, const std::vector<std::string>& settings = {}) {
    write("m.mtl", "newmtl leaves\n" + statements + "newmtl floor\nKd .5 .5 .5\n");
    return read_scene(write("m.obj",
                            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\n"
                            "usemtl leaves\nf 1 2 3\nusemtl floor\nf 4 5 6\n"),
                      with(settings));
  }
};

TEST_F(ObjMasks, AlphaOfTheColoursOwnPictureWeighsThem) {
  write("four.png", four_pixels({255, 0, 255, 0}));
  const Scene scene = read("Kd .8 .8 .8\nmap_Kd four.png\nmap_d four.png\n");
  expect_holes(scene.materials[0], .5, .8 * rgb(.25, .25, 0));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::cut_out_material, {"leaves (0.5)"}));
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::simplified_part));
}

TEST_F(ObjMasks, AGreyPictureCoversByItsNumbers) {
  // Linear numbers without gamma: 0, 0.2, 0.6 and 1.
  write("grey.png", png_of(2, 2, std::string("\0\0\0\x33\x33\x33\x99\x99\x99\xFF\xFF\xFF", 12)));
  expect_holes(read("Kd .8 .4 .2\nmap_d grey.png\n").materials[0], .45, .45 * rgb(.8, .4, .2));
}

// T = 1 - m + m (1 - d) Tf, with the index of the file.
TEST_F(ObjMasks, AreTimesD) {
  write("four.png", four_pixels({255, 0, 255, 0}));
  const Material material = read("Kd .4 .4 .4\nd .6\nTf 1 1 .5\nNi 1.45\nmap_d four.png\n").materials[0];
  expect_near(material.transmittance, rgb(.7, .7, .6));
  expect_near(material.reflectance, rgb(.2, .2, .2));
  EXPECT_EQ(material.index, 1.45);
}

TEST_F(ObjMasks, OfLampsEmitByWhatTheyCover) {
  write("four.png", four_pixels({255, 0, 255, 0}));
  const std::string lamp = "Kd .4 .4 .4\nKe 1 2 3\nmap_d four.png\n";
  expect_near(read(lamp).materials[0].exitance, std::numbers::pi / 2 * rgb(1, 2, 3));
  expect_near(read(lamp, {"leaves.transmittance=0"}).materials[0].exitance, std::numbers::pi * rgb(1, 2, 3));
}

// Another channel or changed numbers would give other holes.
TEST_F(ObjMasks, WithOptionsThatChangeNumbersAreIgnored) {
  write("four.png", four_pixels({255, 0, 255, 0}));
  for (const char* options : {"-imfchan r", "-imfchan l", "-mm 0.1 0.5", "-mm 0 0.5"}) {
    SCOPED_TRACE(options);
    const Scene scene = read("Kd .8 .8 .8\nmap_d " + std::string(options) + " four.png\n");
    EXPECT_FALSE(scene.materials[0].stated_pane);
    EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"map_d", "leaves"}));
  }
  for (const char* options : {"-imfchan m", "-mm 0 1", "-clamp on"})
    EXPECT_TRUE(read("Kd .8 .8 .8\nmap_d " + std::string(options) + " four.png\n").materials[0].stated_pane) << options;
}

TEST_F(ObjMasks, WithoutAlphaTheColourPictureIsNone) {
  write("two.png", two_pixels());
  const Scene scene = read("Kd .8 .8 .8\nmap_Kd two.png\nmap_d two.png\n");
  EXPECT_FALSE(scene.materials[0].stated_pane);
  EXPECT_FALSE(has(scene.diagnostics, DiagnosticCode::simplified_part));
}

TEST_F(ObjMasks, ThatCannotBeReadAreNamed) {
  const Scene scene = read("Kd .8 .8 .8\nmap_d none.png\n");
  EXPECT_FALSE(scene.materials[0].stated_pane);
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::unreadable_picture, {"none.png", "'leaves'", "map_d", "line 3"}));
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_part, {"map_d", "leaves"}));
}

}  // namespace
}  // namespace patchlight::masks_test
