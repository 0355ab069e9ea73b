#include "cli/option_names.h"

#include "patchlight/base/error.h"

#include "cli/arguments.h"
#include "plan/check_request.h"
#include "support/contradictions.h"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>

namespace patchlight::option_names_test {
namespace {

using namespace test;
using namespace cli;

TEST(OptionNames, StandInPlaceOfFieldsAndTheirValues) {
  EXPECT_EQ(with_option_names("effects.skip=sun: found with accuracy.relative_error; give one of them"),
            "--disable sun: found with --accuracy; give one of them");
  EXPECT_EQ(with_option_names("ask for mesh.patches."), "ask for --patches.");
  EXPECT_EQ(with_option_names("(mesh.sides=auto)"), "(--sides auto)");
  for (const char* unit : {"m", "cm", "mm", "in", "ft"}) {
    const char* const metres = unit == std::string("m")    ? "1"
                               : unit == std::string("cm") ? "0.01"
                               : unit == std::string("mm") ? "0.001"
                               : unit == std::string("in") ? "0.0254"
                                                           : "0.3048";
    EXPECT_EQ(with_option_names(std::string("read.metres_per_unit=") + metres), std::string("--unit ") + unit);
  }
}

TEST(OptionNames, LeaveAllElseAsItIs) {
  for (const char* text :
       {"", "room.obj:12: found no faces", "mesh.patches_of", "a.mesh.patches", "remesh.patches", "accuracy", "mesh.",
        "read.settings_", "'mesh.sides'", "/tmp/mesh.patches", "mesh.max_edge.obj", "\xc3\xa9"}) {
    EXPECT_EQ(with_option_names(text), text);
  }
}

TEST(OptionNames, OfACommandGoBeforeTheUsualOnes) {
  const std::array own{OptionName{"accuracy.error_bars", "the error bars of crosscheck"}};
  EXPECT_EQ(with_option_names("accuracy.error_bars and mesh.sides=both", own),
            "the error bars of crosscheck and --sides both");
  Request request;
  request.assembly.close = false;
  request.accuracy.error_bars = true;
  try {
    check_with_names(request, own);
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("the error bars of crosscheck"), std::string::npos) << error.what();
  }
}

// Options name every part of a request that the tool offers and check() may reject.
TEST(OptionNames, AreKnownForAllThatARequestCanBeRefusedFor) {
  const auto no_option = [](const RequestPart& part) {
    return part.name == "mesh.kept_sides" || part.name == "given.mesh" || part.name == "assembly.keep_errors";
  };
  for (const RequestPart& one : request_parts()) {
    for (const RequestPart& other : request_parts()) {
      if (no_option(one) || no_option(other)) continue;
      Request request;
      Given given;
      one.ask(request, given);
      other.ask(request, given);
      try {
        check(request, given);
      } catch (const InputError& error) {
        const std::string said = with_option_names(error.what());
        EXPECT_TRUE(said.starts_with("--")) << said;
        for (const char* part : {"mesh.", "assembly.", "effects.", "solver.", "accuracy.", "given."})
          EXPECT_EQ(said.find(part), std::string::npos) << said;
      }
    }
  }
}

}  // namespace
}  // namespace patchlight::option_names_test
