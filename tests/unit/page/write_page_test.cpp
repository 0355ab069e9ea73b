#include "page/write_page.h"

#include "temporary_folder.h"
#include "tiny_simulation.h"

#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace patchlight::write_page_test {
namespace {

using Json = nlohmann::json;

Json data_in(const std::string& page) {
  const std::string start = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(start) + start.size();
  return Json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

std::string page_with(const Scene& scene, const Simulation& solved) {
  const Simulation simulation = in_scene(solved, scene);
  const SolvedSurface surface = surface_of(simulation);
  const Report report = report_of(scene, {}, simulation);
  return page_of(
      {.scene = scene, .provenance = {"patchlight solve x", 1, "abcd"}, .surface = &surface, .report = &report});
}

TEST(WritePage, HoldsTheModelAndTheReport) {
  const Json data = data_in(page_with(tiny_scene(), tiny_simulation_with_bars()));
  EXPECT_EQ(data["report"]["command_line"], "patchlight solve x");
  EXPECT_EQ(data["scene_hash"], "abcd");
  EXPECT_EQ(data["model"]["patches"], 3);
  EXPECT_EQ(data["model"]["faces"], 3);
  EXPECT_EQ(data["model"]["materials"][1], "lamp");
  for (const char* name : {"radiance", "irradiance", "luminance", "illuminance", "error_total", "display_error"})
    EXPECT_TRUE(data["model"]["values"].contains(name)) << name;
}

// A radiance of 0.5 behind a pane has 0.5^(1/2.2) of its display value.
TEST(WritePage, TellsHowOpaqueMaterialsAreAndWhichHaveAPicture) {
  Scene scene = tiny_scene();
  scene.materials[1].transmittance = rgb(0.5, 0.5, 0.5);
  scene.materials[0].texture = TexturedReflectance{};
  const Json model = data_in(page_with(scene, tiny_simulation()))["model"];
  EXPECT_EQ(model["opacity"][0], 1);
  EXPECT_NEAR(model["opacity"][1].get<double>(), 1 - 0.72974, 1e-5);
  EXPECT_EQ(model["textured"], Json::array({"floor"}));
  EXPECT_FALSE(model["rows"].contains("enclosed"));
}

TEST(WritePage, TellsWhichPatchesAreEnclosedByDay) {
  Simulation simulation = tiny_simulation();
  simulation.enclosed = Eigen::Vector3d(1, 0, 0);
  const Json model = data_in(page_with(tiny_scene(), simulation))["model"];
  EXPECT_EQ(model["rows"]["enclosed"]["components"], 1);
  EXPECT_EQ(model["looks"].size(), 2U);
}

TEST(WritePage, IsOneFileWithTheLicenceOfWhatItTakesIn) {
  const std::string page = page_with(tiny_scene(), tiny_simulation());
  for (const char* word : {" src=\"http", "href=\"http", "<link", "import("}) EXPECT_EQ(count(page, word), 0U) << word;
  EXPECT_NE(page.find("three.js authors"), std::string::npos);
  EXPECT_NE(page.find("Permission is hereby granted"), std::string::npos);
  for (const char* mark : {"@TITLE@", "@DATA@", "@SCRIPT@", "@STYLE@", "@LICENCE@"})
    EXPECT_EQ(count(page, mark), 0U) << mark;
}

// For any name, the page has the same elements as with plain names, and the name can be read back.
TEST(WritePage, TakesHostileNamesForText) {
  const std::size_t elements = count(page_with(tiny_scene(), tiny_simulation()), "<");
  for (const std::string name : {"</script><script>alert(1)</script>", "<!--<script>", "\"'><img src=x onerror=y>",
                                 "\U0001F4A1 &lt; \\u003c", "@DATA@ @TITLE@", "line\nbreak\u2028"}) {
    Scene scene = tiny_scene();
    scene.file = name;
    scene.diagnostics = {{DiagnosticCode::simplified_part, name}};
    scene.materials[0].name = name;
    scene.groups = {name};
    const std::string page = page_with(scene, tiny_simulation());
    EXPECT_EQ(count(page, "<"), elements) << name;
    const Json data = data_in(page);
    EXPECT_EQ(data["model"]["materials"][0], name);
    EXPECT_EQ(data["report"]["input"]["notes"][0]["text"], name);
  }
}

TEST(WritePage, ReplacesBytesThatAreNoText) {
  Scene scene = tiny_scene();
  scene.file = "\xff\xfe.obj";
  scene.materials[0].name = "\xc3";
  const std::string page = page_with(scene, tiny_simulation());
  EXPECT_EQ(data_in(page)["model"]["materials"][0], "\uFFFD");
  EXPECT_NE(page.find("<title>\uFFFD\uFFFD.obj"), std::string::npos);
}

// JSON has no such numbers: they are null there, and keep their values in packed arrays.
TEST(WritePage, TakesNumbersThatAreNotFinite) {
  Simulation simulation = tiny_simulation_with_bars();
  simulation.error_bars->mesh(0, 0) = std::numeric_limits<double>::quiet_NaN();
  simulation.accuracy.back().total = std::numeric_limits<double>::infinity();
  simulation.solution.history.back().error_bound = std::numeric_limits<double>::quiet_NaN();
  const Json data = data_in(page_with(tiny_scene(), simulation));
  EXPECT_TRUE(data["report"]["relative_error"]["total"].is_null());
  EXPECT_TRUE(data["report"]["solution"]["iterations"][1]["error_bound"].is_null());
}

TEST(WritePage, WritesTheSameBytes) {
  const TemporaryFolder folder;
  const Scene scene = tiny_scene();
  write_page(folder.path() / "page.html", {.scene = scene});
  EXPECT_EQ(content_of(folder.path() / "page.html"), page_of({.scene = scene}));
}

}  // namespace
}  // namespace patchlight::write_page_test
