#include "patchlight/base/error.h"

#include "input/read_isolated.h"
#include "support/scenes.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

namespace patchlight::isolated_test {
namespace {

std::string refusal(const std::function<Scene()>& read) {
  try {
    read_isolated("room.dae", read, {.seconds = 1});
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "was read";
  return {};
}

TEST(ReadIsolated, GivesWhatIsRead) {
  Scene scene = test::furnished_room(0.5);
  scene.file = "room.dae";
  scene.diagnostics = {{DiagnosticCode::read_as_pane, "a note", 3, {}, 0.5}};
  scene.materials[1].transmittance = Spectrum::Constant(1, 0.5);
  scene.materials[1].index = 1.4;
  scene.materials[1].diffuse_transmittance = Spectrum::Constant(1, 0.25);
  scene.materials[1].stated_pane = StatedSurface{"opacity 0.5", Spectrum::Constant(1, 0.3)};
  scene.materials[0].specular_reflectance = Spectrum::Constant(1, 0.6);
  scene.materials[0].stated_mirror = StatedSurface{"a smooth metal", Spectrum::Constant(1, 0.7)};
  const Scene read = read_isolated("room.dae", [&] { return scene; });
  EXPECT_EQ(read.vertices, scene.vertices);
  EXPECT_EQ(read.polygons.size(), scene.polygons.size());
  EXPECT_EQ(read.materials.size(), scene.materials.size());
  ASSERT_EQ(read.diagnostics.size(), 1U);
  EXPECT_EQ(read.diagnostics[0].code, DiagnosticCode::read_as_pane);
  EXPECT_EQ(read.diagnostics[0].text, "a note");
  EXPECT_EQ(read.diagnostics[0].count, 3U);
  EXPECT_EQ(read.diagnostics[0].area, 0.5);
  EXPECT_EQ(read.materials[0].transmittance.size(), 0);
  EXPECT_EQ(read.materials[1].transmittance[0], 0.5);
  EXPECT_EQ(read.materials[1].index, 1.4);
  EXPECT_EQ(read.materials[0].diffuse_transmittance.size(), 0);
  EXPECT_EQ(read.materials[1].diffuse_transmittance[0], 0.25);
  ASSERT_TRUE(read.materials[1].stated_pane);
  EXPECT_EQ(read.materials[1].stated_pane->by, "opacity 0.5");
  EXPECT_EQ(read.materials[1].stated_pane->matt_reflectance[0], 0.3);
  EXPECT_EQ(read.materials[1].specular_reflectance.size(), 0);
  EXPECT_FALSE(read.materials[1].stated_mirror);
  EXPECT_EQ(read.materials[0].specular_reflectance[0], 0.6);
  ASSERT_TRUE(read.materials[0].stated_mirror);
  EXPECT_EQ(read.materials[0].stated_mirror->by, "a smooth metal");
  EXPECT_EQ(read.materials[0].stated_mirror->matt_reflectance[0], 0.7);
}

TEST(ReadIsolated, ARefusalKeepsItsWords) {
  EXPECT_EQ(refusal([]() -> Scene { throw InputError("room.dae", "is odd"); }), "room.dae: is odd");
}

TEST(ReadIsolated, WhateverElseHappensIsARefusalOfTheFile) {
  const std::vector<std::function<Scene()>> readers = {
      []() -> Scene { throw std::runtime_error("odd"); },
      []() -> Scene { std::abort(); },
      []() -> Scene {
        for (std::atomic<bool> forever = true; forever;) {
        }
        return {};
      },
  };
  for (const auto& read : readers) {
    const std::string message = refusal(read);
    EXPECT_EQ(message.rfind("room.dae: ", 0), 0U) << message;
    EXPECT_NE(message.find("export it again"), std::string::npos) << message;
  }
}

// assimp does not stop at some damaged numbers, and would use all memory of the machine.
TEST(ReadIsolated, ASignalThatStopsTheProgramIsNoFaultOfTheFile) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP})
    EXPECT_THROW(read_isolated("a.gltf",
                               [&]() -> Scene {
                                 raise(signal);
                                 return {};
                               }),
                 Canceled);
}

TEST(ReadIsolated, MemoryIsLimited) {
  const auto take_three_gigabytes = [] {
    std::vector<std::unique_ptr<char[]>> taken;
    while (taken.size() < 3) taken.push_back(std::make_unique_for_overwrite<char[]>(std::size_t{1} << 30U));
    return Scene();
  };
  EXPECT_EQ(refusal(take_three_gigabytes).rfind("room.dae: ", 0), 0U);
}

std::string output(const std::string& script, const std::string& input = "") {
  return output_isolated("room.ifc", {{"/bin/sh", "-c", script}, {}}, input, {.seconds = 1});
}

std::string refusal_of_program(const std::string& script) {
  try {
    output(script);
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << script << " ended well";
  return {};
}

TEST(OutputIsolated, IsThatOfTheProgram) {
  const std::string much(300'000, 'x');
  EXPECT_EQ(output("cat", much), much);
  EXPECT_EQ(output("env | grep -c HOME || echo none"), "0\nnone\n");
}

TEST(OutputIsolated, ProgramsThatFailOrNeverEndAreARefusalOfTheFile) {
  for (const std::string script : {"exit 3", "kill -9 $$", "true", "while :; do :; done"}) {
    const std::string message = refusal_of_program(script);
    EXPECT_EQ(message.rfind("room.ifc: ", 0), 0U) << message;
    EXPECT_NE(message.find("export it again"), std::string::npos) << message;
  }
  EXPECT_NE(refusal_of_program("while :; do :; done"), refusal_of_program("exit 3"));
}

// The processor time that a child has for a file of a size, in seconds.
unsigned long seconds_for(std::size_t bytes) {
  const std::string file = testing::TempDir() + "patchlight_seconds_test_" + std::to_string(getpid());
  std::ofstream(file) << std::string(bytes, ' ');
  const std::string seconds = output_isolated(file, {{"/bin/sh", "-c", "ulimit -t"}, {}}, "");
  std::remove(file.c_str());
  return std::stoul(seconds);
}

// A damaged line of 40 bytes makes web-ifc loop without end.
TEST(OutputIsolated, TheTimeGrowsWithTheFileAndSmallFilesEndSoon) {
  const unsigned long least = seconds_for(2'000);
  EXPECT_LE(least, 10U);
  EXPECT_EQ(seconds_for(5'000'000), least + 50);
}

TEST(OutputIsolated, MemoryIsLimited) {
  EXPECT_EQ(refusal_of_program("exec /usr/bin/python3 -c 'x = bytearray(3 << 30); print(1)'").rfind("room.ifc: ", 0),
            0U);
}

// Linux has Landlock since version 5.13. landlock_create_ruleset(2) returns its version on request.
bool has_landlock() {
#ifdef SYS_landlock_create_ruleset
  constexpr unsigned asks_version = 1;
  return syscall(SYS_landlock_create_ruleset, nullptr, 0, asks_version) > 0;
#else
  return false;
#endif
}

// Without Landlock, files remain accessible.
TEST(OutputIsolated, OpensNoConnectionsAndWritesNoFiles) {
  EXPECT_EQ(output("/usr/bin/python3 -c 'import socket; socket.socket()' 2>/dev/null || echo none"), "none\n");
  const std::string file = testing::TempDir() + "patchlight_isolated_test_" + std::to_string(getpid());
  std::ofstream(file) << "secret";
  const std::string found =
      output("echo x 2>/dev/null >" + file + " || echo none; cat " + file + " 2>/dev/null; echo end");
  EXPECT_EQ(found, has_landlock() ? "none\nend\n" : "x\nend\n");
  std::remove(file.c_str());
}

}  // namespace
}  // namespace patchlight::isolated_test
