#include "patchlight/output/write_result.h"

#include "temporary_folder.h"
#include "tiny_simulation.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace patchlight::write_report_test {
namespace {

nlohmann::json written_report(const Scene& scene, const Simulation& simulation) {
  const TemporaryFolder folder;
  Request request;
  request.mesh.max_edge = 0.25;
  const Provenance provenance{"patchlight solve tiny.obj", 0.125};
  write_report(folder.path() / "report.json", report_of(scene, request, simulation), provenance);
  return nlohmann::json::parse(content_of(folder.path() / "report.json"));
}

// With B = E + rho o H: sum A E - sum A (1 - rho) H = sum A (B - H).
TEST(WriteReport, FluxesOfTheMaterialsAddUp) {
  const Simulation simulation = tiny_simulation();
  const nlohmann::json report = written_report(tiny_scene(), simulation);
  double area = 0;
  Eigen::Array3d net = Eigen::Array3d::Zero();
  for (const auto& material : report["materials"]) {
    area += material["area_m2"].get<double>();
    for (int band = 0; band < 3; ++band) {
      net[band] += material["flux_emitted_W"][band].get<double>() - material["flux_absorbed_W"][band].get<double>();
      const double mean = material["irradiance_mean_W_m2"][band];
      EXPECT_LE(material["irradiance_min_W_m2"][band].get<double>(), mean * (1 + 1e-15));
      EXPECT_GE(material["irradiance_max_W_m2"][band].get<double>(), mean * (1 - 1e-15));
    }
  }
  const Eigen::VectorXd& areas = simulation.problem.area;
  EXPECT_NEAR(area, areas.sum(), 1e-14);
  const Eigen::Array3d expected =
      ((simulation.solution.radiosity - simulation.solution.irradiance).matrix().transpose() * areas).array();
  for (int band = 0; band < 3; ++band) {
    // Six products and sums of numbers up to 50, rounded to 1e-16 each.
    EXPECT_NEAR(net[band], expected[band], 1e-13);
  }
}

TEST(WriteReport, TellsWhatWasAskedDoneAndFound) {
  const nlohmann::json report = written_report(tiny_scene(), tiny_simulation());
  EXPECT_EQ(report["version"], version());
  EXPECT_EQ(report["command_line"], "patchlight solve tiny.obj");
  EXPECT_EQ(report["input"]["sha256"], "00ff");
  EXPECT_EQ(report["input"]["notes"][0]["code"], "simplified_part");
  EXPECT_EQ(report["input"]["notes"][0]["text"], "a note");
  EXPECT_EQ(report["request"]["max_edge_m"], 0.25);
  EXPECT_TRUE(report["request"]["patches"].is_null());
  EXPECT_EQ(report["plan"]["seed"], (std::uint64_t{1} << 60) + 1);
  const auto& decision = report["plan"]["decisions"][0];
  EXPECT_EQ(decision["effect"], "occlusion");
  EXPECT_EQ(decision["simulate"], false);
  EXPECT_EQ(decision["reason"], "a reason");
  EXPECT_EQ(decision["saving"], "a saving");
  EXPECT_EQ(decision["forced"], true);
  EXPECT_EQ(report["mesh"]["patches"], 3);
  EXPECT_EQ(report["transport"]["lost_share_rays"], 3 * 64);
  EXPECT_EQ(report["transport"]["raw_row_sum"]["max"], 0.75);
  EXPECT_EQ(report["solution"]["iterations"].size(), 2U);
  EXPECT_EQ(report["costs"][1]["stage"], "solve");
  EXPECT_EQ(report["energy_balance"]["emitted_W"], (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(report["energy_balance"]["arriving_W"], (std::vector<double>{2, 4, 6}));
  EXPECT_GT(report["memory_peak_bytes"], 1 << 20);
  EXPECT_EQ(report["exposure"], 0.125);
}

TEST(WriteReport, TellsWhatAccuracyHasCost) {
  const nlohmann::json report = written_report(tiny_scene(), tiny_simulation_with_bars());
  EXPECT_EQ(report["relative_error"], (nlohmann::json{{"mesh", 0.03},
                                                      {"form_factor", 0.04},
                                                      {"solver", 0.001},
                                                      {"total", 0.05},
                                                      {"display", 0.25},
                                                      {"inside", false}}));
  ASSERT_EQ(report["accuracy"].size(), 2U);
  EXPECT_EQ(report["accuracy"][0]["mesh"], 0.5);
  const nlohmann::json last = report["accuracy"][1];
  EXPECT_EQ(last["patches"], 3);
  EXPECT_EQ(last["new_patches"], 1);
  EXPECT_EQ(last["samples"], 32);
  EXPECT_EQ(last["total"], 0.05);
  EXPECT_EQ(last["seconds"], 2);
  EXPECT_EQ(last["cpu_seconds"], 4);
  EXPECT_TRUE(report["request"].at("accuracy").is_null());
  EXPECT_TRUE(report["request"].at("time_s").is_null());

  const nlohmann::json without = written_report(tiny_scene(), tiny_simulation());
  EXPECT_TRUE(without.at("relative_error").is_null());
  EXPECT_TRUE(without.at("accuracy").empty());
}

// The row sums are 1 - lost, so the closed ones have no defect. The raw ones differ by 0, 1/4 and -1/4.
TEST(WriteReport, WeighsRowSumsByArea) {
  const Simulation simulation = tiny_simulation();
  const nlohmann::json report = written_report(tiny_scene(), simulation);
  const Eigen::VectorXd& area = simulation.problem.area;
  const double raw = std::sqrt((area[1] + area[2]) / area.sum()) / 4;
  EXPECT_NEAR(report["transport"]["raw_row_sum"]["rms_defect"].get<double>(), raw, 1e-15);
  EXPECT_EQ(report["transport"]["row_sum"]["rms_defect"], 0);
  EXPECT_NEAR(report["transport"]["row_sum"]["mean"].get<double>(), 0.5, 1e-15);
}

TEST(WriteReport, SaysWhatIsNotKnownOfRowsOnDemand) {
  Simulation simulation = tiny_simulation();
  simulation.plan.assembly.storage = Storage::on_demand;
  simulation.transport.row_sum = simulation.transport.raw_row_sum = Eigen::VectorXd();
  const nlohmann::json report = written_report(tiny_scene(), simulation);
  for (const char* key : {"facing_pairs", "shadow_rays", "bare_shadow_rays_per_second", "raw_row_sum", "row_sum"}) {
    EXPECT_TRUE(report["transport"].at(key).is_null()) << key;
  }
  EXPECT_TRUE(report["transport"]["worst_rows"].empty());
  EXPECT_TRUE(report["energy_balance"].at("defect_W").is_null());
  EXPECT_EQ(report["energy_balance"]["escaped_W"], (std::vector<double>{1, 2, 3}));
}

// Patches 1 and 2 are equal, so the first is chosen.
TEST(WriteReport, NamesTheWorstPatches) {
  const Simulation simulation = tiny_simulation();
  Scene scene = tiny_scene();
  scene.groups = {"table"};
  scene.polygons[1].line = 7;
  const nlohmann::json worst = written_report(scene, simulation)["transport"]["worst_rows"];
  ASSERT_EQ(worst.size(), 3U);
  EXPECT_EQ(worst[0]["patch"], 1);
  EXPECT_EQ(worst[0]["place"], "tiny.obj:7");
  EXPECT_EQ(worst[0]["source_polygon"], 11);
  EXPECT_EQ(worst[0]["group"], "table");
  EXPECT_EQ(worst[0]["material"], "lamp");
  EXPECT_EQ(worst[0]["centre_m"][1].get<double>(), simulation.mesh.centroid[1].y());
  EXPECT_EQ(worst[0]["raw_row_sum"], 0.75);
  EXPECT_EQ(worst[0]["expected"], 0.5);
  EXPECT_EQ(worst[1]["patch"], 2);
  EXPECT_EQ(worst[2]["patch"], 0);
}

TEST(WriteReport, IsValidJsonWhateverItHolds) {
  Scene scene = tiny_scene();
  scene.materials.push_back({"not \xff UTF-8 \"quoted\"", rgb(0, 0, 0), rgb(0, 0, 0)});  // no patch has it
  const nlohmann::json report = written_report(scene, tiny_simulation());
  EXPECT_TRUE(report["solution"]["iterations"][0]["error_bound"].is_null());  // infinite
  EXPECT_EQ(report["materials"][2]["area_m2"], 0);
  EXPECT_TRUE(report["materials"][2]["irradiance_mean_W_m2"][0].is_null());
  EXPECT_TRUE(report["materials"][2]["irradiance_min_W_m2"][0].is_null());
}

}  // namespace
}  // namespace patchlight::write_report_test
