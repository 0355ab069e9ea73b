// Textures of COLLADA files have the same positions as those of the same square in OBJ.
#include "light/texture.h"
#include "model_files.h"

#include <gtest/gtest.h>

namespace patchlight::collada_pictures_test {
namespace {

// Red, green, blue, white: from the top left, row by row.
const std::string four_colours("\xFF\0\0\0\xFF\0\0\0\xFF\xFF\xFF\xFF", 12);

const Spectrum red = rgb(1, 0, 0);
const Spectrum green = rgb(0, 1, 0);
const Spectrum blue = rgb(0, 0, 1);
const Spectrum white = rgb(1, 1, 1);

class ColladaPictures : public ModelFiles {
 protected:
  // A square whose corner k lies at places[k] of (0 0, 1 0, 1 1, 0 1) in the texture, with v upwards.
  std::filesystem::path square(const std::string& places, const std::string& picture = "four.png",
                               const std::string& sampler = "", const std::string& node = "",
                               const std::string& effect = "") {
    const auto source = [](const std::string& id, const std::string& numbers, const std::string& count,
                           const std::string& stride) {
      return "<source id=\"" + id + "\"><float_array id=\"" + id + "a\" count=\"" + count + "\">" + numbers +
             "</float_array><technique_common><accessor source=\"#" + id + "a\" stride=\"" + stride +
             "\" count=\"4\"><param name=\"" + (stride == "3" ? "X" : "S") + "\" type=\"float\"/><param name=\"" +
             (stride == "3" ? "Y" : "T") + "\" type=\"float\"/>" +
             (stride == "3" ? "<param name=\"Z\" type=\"float\"/>" : "") + "</accessor></technique_common></source>";
    };
    std::string corners;
    for (std::size_t k = 0; k < 4; ++k) corners += std::to_string(k) + " " + places[k] + " ";
    return write(
        "square.dae",
        R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)"
        R"(<up_axis>Z_UP</up_axis></asset><library_images><image id="i"><init_from>)" +
            picture +
            R"(</init_from></image></library_images><library_effects><effect id="e"><profile_COMMON>)"
            R"(<newparam sid="s"><surface type="2D"><init_from>i</init_from></surface></newparam>)"
            R"(<newparam sid="p"><sampler2D><source>s</source></sampler2D></newparam><technique sid="t"><lambert>)"
            R"(<diffuse><texture texture="p" texcoord="UV">)" +
            sampler + "</texture></diffuse>" + effect +
            R"(</lambert></technique></profile_COMMON></effect></library_effects><library_materials>)"
            R"(<material id="paint" name="paint"><instance_effect url="#e"/></material></library_materials>)"
            R"(<library_geometries><geometry id="g"><mesh>)" +
            source("p", "0 0 0 1 0 0 1 1 0 0 1 0", "12", "3") + source("q", "0 0 1 0 1 1 0 1", "8", "2") +
            R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><polylist material="m" count="1">)"
            R"(<input semantic="VERTEX" source="#v" offset="0"/><input semantic="TEXCOORD" source="#q" offset="1" set="0"/>)"
            "<vcount>4</vcount><p>" +
            corners +
            R"(</p></polylist></mesh></geometry></library_geometries><library_visual_scenes><visual_scene id="s">)"
            R"(<node id="n">)" +
            node +
            R"(<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m")"
            R"( target="#paint"><bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/>)"
            R"(</instance_material></technique_common></bind_material></instance_geometry></node></visual_scene>)"
            R"(</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  }
  void SetUp() override {
    ModelFiles::SetUp();
    write("four.png", png_of(2, 2, four_colours));
  }
};

// The reflectance at a point of the first polygon.
Spectrum seen_at(const Scene& scene, const Point& point) {
  const Material& material = scene.materials[scene.polygons[0].material];
  const TextureMap* map = texture_map_on(scene, scene.polygons[0], Side::front);
  return map ? reflectance_at(*material.texture, map->linear * point + map->offset) : material.reflectance;
}

void expect_corners(const Scene& scene, const std::array<Spectrum, 4>& expected, const Point& middle = {.5, .5, 0}) {
  const std::array<Vector, 4> away = {Vector(-.25, .25, 0), Vector(.25, .25, 0), Vector(-.25, -.25, 0),
                                      Vector(.25, -.25, 0)};
  for (std::size_t k = 0; k < 4; ++k) {
    const Spectrum found = seen_at(scene, middle + away[k]);
    EXPECT_TRUE((found == expected[k]).all()) << "place " << k << ": " << found.transpose();
  }
}

TEST_F(ColladaPictures, LieWhereTheirCoordinatesSay) {
  expect_corners(read_scene(square("0123")), {red, green, blue, white});
  expect_corners(read_scene(square("1230")), {blue, red, white, green});
  expect_corners(read_scene(square("1032")), {green, red, white, blue});
}

// v points up in both formats.
TEST_F(ColladaPictures, LieAsThoseOfObjDo) {
  write("m.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd four.png\n");
  const std::string head =
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl paint\n";
  for (const std::string& places : {std::string("0123"), std::string("1230"), std::string("2103")}) {
    std::string face = "f";
    for (std::size_t k = 0; k < 4; ++k) face += " " + std::to_string(k + 1) + "/" + std::to_string(places[k] - '0' + 1);
    const Scene expected = read_scene(write("m.obj", head + face + "\n"));
    const Scene found = read_scene(square(places));
    for (const Point& point : {Point(.2, .7, 0), Point(.8, .7, 0), Point(.2, .3, 0), Point(.8, .3, 0)})
      EXPECT_TRUE((seen_at(found, point) == seen_at(expected, point)).all()) << places;
  }
}

// A node that mirrors x: the texture is mirrored, and the front stays on the same side.
TEST_F(ColladaPictures, GoWithTheirNodes) {
  const Scene mirrored =
      read_scene(square("0123", "four.png", "", "<matrix>-1 0 0 3 0 1 0 2 0 0 1 0 0 0 0 1</matrix>"));
  expect_corners(mirrored, {green, red, white, blue}, {2.5, 2.5, 0});
}

TEST_F(ColladaPictures, GoOnBeyondTheirEdgesAsTheirExtrasSay) {
  const auto with = [](const std::string& statements) {
    return "<extra><technique profile=\"MAYA\">" + statements + "</technique></extra>";
  };
  const auto moved = [&](const std::string& sampler) {
    std::filesystem::path file = square("0123", "four.png", sampler);
    std::ifstream in(file);
    std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::string places = "0 0 1 0 1 1 0 1";
    text.replace(text.find(places), places.size(), "1 0 2 0 2 1 1 1");
    in.close();
    return read_scene(write("square.dae", text));
  };
  expect_corners(moved(""), {red, green, blue, white});
  expect_corners(moved(with("<mirrorU>1</mirrorU>")), {green, red, white, blue});
  expect_corners(moved(with("<wrapU>0</wrapU>")), {green, green, white, white});
}

TEST_F(ColladaPictures, AreFoundUnderTheirEncodedNames) {
  std::filesystem::create_directories(folder_ / "wall paper");
  write("wall paper/four é.png", png_of(2, 2, four_colours));
  for (const char* name :
       {"wall%20paper/four%20%C3%A9.png", "./wall%20paper/four%20%c3%a9.png", "wall paper/four é.png"})
    expect_corners(read_scene(square("0123", name)), {red, green, blue, white});
}

TEST_F(ColladaPictures, ThatAreMissingAreNamedAndGrey) {
  const Scene scene = read_scene(square("0123", "none.png"));
  EXPECT_FALSE(scene.materials[0].texture);
  EXPECT_TRUE((scene.materials[0].reflectance == .5).all());
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::unreadable_picture, {"none.png", "'paint'"}));
}

TEST_F(ColladaPictures, ThatAreDamagedAreNamedAndGrey) {
  write("half.png", png_of(2, 2, four_colours).substr(0, 50));
  const Scene scene = read_scene(square("0123", "half.png"));
  EXPECT_FALSE(scene.materials[0].texture);
  EXPECT_EQ(scene.polygons[0].texture_map, no_texture_map);
  EXPECT_TRUE((scene.materials[0].reflectance == .5).all());
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::unreadable_picture, {"half.png", "'paint'"}));
}

TEST_F(ColladaPictures, OfOneColourAreTheMaterial) {
  write("green.png", png_of(1, 1, std::string("\0\xFF\0", 3)));
  const Scene scene = read_scene(square("0123", "green.png"));
  EXPECT_FALSE(scene.materials[0].texture);
  EXPECT_TRUE(scene.texture_maps.empty());
  EXPECT_TRUE((scene.materials[0].reflectance == green).all());
}

TEST_F(ColladaPictures, OutsideOfTheFolderAreNotRead) {
  const std::filesystem::path& folder = folder_;
  std::filesystem::create_directories(folder / "inner");
  const std::filesystem::path outside = square("0123", "../four.png");
  std::filesystem::rename(outside, folder / "inner" / "square.dae");
  ReadOptions options;
  EXPECT_TRUE(read_scene(folder / "inner" / "square.dae", options).materials[0].texture);
  options.confine = folder / "inner";
  const Scene scene = read_scene(folder / "inner" / "square.dae", options);
  EXPECT_FALSE(scene.materials[0].texture);
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::unreadable_picture, {"four.png", "'paint'"}));
}

TEST_F(ColladaPictures, BelongToTheChecksum) {
  const std::filesystem::path file = square("0123");
  const std::string before = read_scene(file).sha256;
  EXPECT_EQ(read_scene(file).sha256, before);
  std::string other = four_colours;
  other[0] = '\x10';
  const std::filesystem::path picture = write("four.png", png_of(2, 2, other));
  const Scene scene = read_scene(file);
  EXPECT_NE(scene.sha256, before);
  EXPECT_NE(std::find(scene.inputs.begin(), scene.inputs.end(), picture), scene.inputs.end());
}

TEST_F(ColladaPictures, OfPanesCountByTheirMean) {
  const std::string clear =
      "<transparent opaque=\"A_ONE\"><color>1 1 1 1</color></transparent>"
      "<transparency><float>0.25</float></transparency>";
  const Scene scene = read_scene(square("0123", "four.png", "", "", clear));
  EXPECT_FALSE(scene.materials[0].texture);
  EXPECT_TRUE((scene.materials[0].stated_pane->matt_reflectance == .5).all());
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::simplified_picture, {"paint"}));
  const Scene without = read_scene(square("0123", "none.png", "", "", clear));
  EXPECT_TRUE(has(without.diagnostics, DiagnosticCode::unreadable_picture, {"none.png", "'paint'"}));
  EXPECT_FALSE(has(without.diagnostics, DiagnosticCode::simplified_picture));
}

}  // namespace
}  // namespace patchlight::collada_pictures_test
