#include "patchlight/input/read_scene.h"

#include "model_files.h"

namespace patchlight::chosen_faces_test {
namespace {

class ChosenFaces : public ModelFiles {
 protected:
  ChosenFaces() {
    write("room.mtl", "newmtl wood\nKd .5 .4 .3\nnewmtl paint\nKd .8 .8 .8\n");
    write("room.obj",
          "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 3\nv 3 0 3\nv 3 1 3\nv 0 1 3\n"
          "g floor\nusemtl wood\nf 1 2 3 4\ng IfcTable_1\nusemtl wood\nf 1 2 6 5\n"
          "g ceiling\nusemtl paint\nf 5 8 7 6\n");
  }
  Scene with(const std::vector<std::string>& only, const std::vector<std::string>& leave_out) const {
    ReadOptions options;
    options.only = only;
    options.leave_out = leave_out;
    return read_scene(folder_ / "room.obj", options);
  }
};

std::vector<std::string> names_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const Polygon& polygon : scene.polygons) names.push_back(group_name(scene, polygon.group));
  return names;
}

TEST_F(ChosenFaces, AreThoseOfTheNamesAndPatterns) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(names_of(with({}, {"IfcTab*"})), (Names{"floor", "ceiling"}));
  EXPECT_EQ(names_of(with({"wood"}, {})), (Names{"floor", "IfcTable_1"}));
  EXPECT_EQ(names_of(with({"wood"}, {"IfcTable_?"})), (Names{"floor"}));
}

TEST_F(ChosenFaces, TellWhatWentAndLeaveNoMaterialWithoutFaces) {
  const Scene scene = with({}, {"ceiling"});
  ASSERT_EQ(scene.materials.size(), 1U);
  EXPECT_EQ(scene.materials[0].name, "wood");
  EXPECT_TRUE(has(scene.diagnostics, DiagnosticCode::reduced_model, {"1 face", "1 object"}));
}

TEST_F(ChosenFaces, RefuseNamesOfNothing) {
  const auto refused = [this](const std::vector<std::string>& only, const std::vector<std::string>& leave_out) {
    try {
      with(only, leave_out);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused({}, {"cieling"}).find(" 'ceiling'?"), std::string::npos);
  EXPECT_NE(refused({"lamp*"}, {}).find("read.only"), std::string::npos);
  EXPECT_NE(refused({}, {"*"}).find("no face remains"), std::string::npos);
}

// A scene file names one of several models.
TEST_F(ChosenFaces, OfOneModelOfASceneFile) {
  const Scene scene =
      read_scene(write("two.toml",
                       "up = \"z\"\n[[model]]\nfile = \"room.obj\"\nonly = \"floor\"\n[[model]]\nfile = \"room.obj\"\n"
                       "translate = [9, 0, 0]\nleave_out = [\"floor\", \"IfcTable*\"]\n"));
  EXPECT_EQ(names_of(scene), (std::vector<std::string>{"floor", "ceiling"}));
}

// Settings for faces of an object apply only to that object, though others have the same material.
TEST_F(ChosenFaces, GetMaterialsOfTheirOwn) {
  const Scene scene =
      read_scene(write("of.toml",
                       "[[model]]\nfile = \"room.obj\"\n[[material]]\nof = \"IfcTable*\"\nreflectance = 0.1\n"
                       "[[material]]\nof = \"IfcTable*\"\nname = \"wood*\"\nradiance = 1\n"
                       "[[material]]\nof = \"*\"\nname = \"paint\"\nreflectance = 0.7\n"));
  ASSERT_EQ(scene.materials.size(), 3U);
  EXPECT_EQ(scene.materials[2].name, "wood of IfcTable*");
  EXPECT_NEAR(scene.materials[2].reflectance[0], 0.1, 1e-12);
  EXPECT_TRUE(is_lamp(scene, 1));
  EXPECT_FALSE(is_lamp(scene, 0));
  EXPECT_NEAR(scene.materials[0].reflectance[0], 0.5, 1e-12);
  EXPECT_NEAR(scene.materials[1].reflectance[0], 0.7, 1e-12);
}

TEST_F(ChosenFaces, AreThoseOfAFile) {
  write("wall.obj", "mtllib room.mtl\nv 5 0 0\nv 6 0 0\nv 6 0 1\nusemtl wood\nf 1 2 3\n");
  const Scene scene = read_scene(write("files.toml",
                                       "[[model]]\nfile = \"room.obj\"\n[[model]]\nfile = \"wall.obj\"\n"
                                       "[[material]]\nof = \"wall.obj\"\nreflectance = [0.6, 0.1, 0.1]\n"));
  EXPECT_NEAR(scene.materials[scene.polygons[3].material].reflectance[0], 0.6, 1e-12);
  EXPECT_NEAR(scene.materials[scene.polygons[0].material].reflectance[0], 0.5, 1e-12);
}

TEST_F(ChosenFaces, RefuseMaterialsOfNothing) {
  const auto refused = [this](const std::string& material) {
    try {
      read_scene(write("bad.toml", "[[model]]\nfile = \"room.obj\"\n[[material]]\n" + material));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(refused("of = \"ciling\"\nreflectance = 0.5\n").find(" 'ceiling'?"), std::string::npos);
  EXPECT_NE(refused("of = \"ceiling\"\nname = \"wood\"\nreflectance = 0.5\n").find("of 'ceiling'"), std::string::npos);
  EXPECT_NE(refused("of = \"ceiling\"\nindex = 1.5\n").find("transmittance"), std::string::npos);
}

}  // namespace
}  // namespace patchlight::chosen_faces_test
