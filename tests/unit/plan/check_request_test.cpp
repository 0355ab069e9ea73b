#include "plan/check_request.h"

#include "patchlight/base/error.h"
#include "patchlight/form_factors.h"
#include "patchlight/simulate.h"

#include "support/contradictions.h"
#include "support/scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace patchlight::check_request_test {
namespace {

using namespace test;

// The message of check() for a request with these parts. Empty if it accepts them.
std::string refusal(const std::vector<RequestPart>& parts) {
  Request request;
  Given given;
  for (const RequestPart& part : parts) part.ask(request, given);
  try {
    check(request, given);
    return {};
  } catch (const InputError& error) {
    return error.what();
  }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool exclude_each_other(const std::string& one, const std::string& other) {
  for (const auto& [part, others] : exclusive_parts()) {
    for (const std::string& excluded : others) {
      if ((part == one && excluded == other) || (part == other && excluded == one)) return true;
    }
  }
  return false;
}

TEST(CheckRequest, AcceptsEveryPartAlone) {
  EXPECT_EQ(refusal({}), "");
  for (const RequestPart& part : request_parts()) EXPECT_EQ(refusal({part}), "") << part.name;
}

// All pairs: check() rejects contradicting pairs, with the names of both parts, and no others.
TEST(CheckRequest, RefusesJustThePairsThatContradict) {
  const std::vector<RequestPart> parts = request_parts();
  for (const RequestPart& one : parts) {
    for (const RequestPart& other : parts) {
      if (one.name == other.name) continue;
      const std::string said = refusal({one, other});
      const bool contradict = exclude_each_other(one.name, other.name);
      EXPECT_EQ(!said.empty(), contradict) << one.name << " and " << other.name << ": " << said;
      if (!contradict) continue;
      EXPECT_TRUE(has(said, one.name) && has(said, other.name)) << said;
    }
  }
}

TEST(CheckRequest, RefusesWhatTheSolverDoesNotTake) {
  for (const Solver solver : all_solvers()) {
    const auto with = [&](const std::function<void(Request&)>& ask) {
      return refusal({{name_of(solver), [&](Request& request, Given&) {
                         request.solver.solver = solver;
                         ask(request);
                       }}});
    };
    const std::string relaxed = with([](Request& request) { request.solver.relaxation = 1.5; });
    EXPECT_EQ(relaxed.empty(), solver == Solver::sor) << relaxed;
    EXPECT_TRUE(relaxed.empty() || has(relaxed, "solver.solver=sor")) << relaxed;
    for (const std::string& said : {with([](Request& request) { request.solver.max_rows = 0.1; }),
                                    with([](Request& request) { request.assembly.storage = Storage::on_demand; })}) {
      EXPECT_EQ(said.empty(), is_shooting(solver)) << said;
      EXPECT_TRUE(said.empty() || (has(said, std::string("solver.solver=") + name_of(solver)) &&
                                   has(said, "solver.solver=progressive")))
          << said;
    }
  }
}

TEST(CheckRequest, RefusesAnInterestWithoutAnErrorThatItCouldBeOf) {
  const RequestPart interest{"accuracy.interest",
                             [](Request& request, Given&) { request.accuracy.interest = {"floor"}; }};
  EXPECT_TRUE(has(refusal({interest}), "accuracy.interest: ")) << refusal({interest});
  for (const RequestPart& part : request_parts()) {
    const bool has_bars = part.name.starts_with("accuracy.");
    EXPECT_EQ(refusal({part, interest}).empty(), has_bars) << part.name;
  }
}

// Error bars exclude the same parts as check() rejects.
TEST(CheckRequest, KnowsWhatLeavesNoErrorBars) {
  EXPECT_FALSE(part_without_error_bars({}));
  for (const RequestPart& part : request_parts()) {
    if (part.name.starts_with("accuracy.")) continue;
    Request request;
    Given given;
    part.ask(request, given);
    const bool excluded = exclude_each_other(part.name, "accuracy.error_bars");
    EXPECT_EQ(part_without_error_bars(request, given).value_or(""), excluded ? part.name : "") << part.name;
  }
}

TEST(CheckRequest, RefusesANumberOfRaysWhereRowsAreNotOfRays) {
  for (const Storage storage : {Storage::automatic, Storage::tiles, Storage::rays}) {
    const std::string said = refusal({{"rays", [&](Request& request, Given&) {
                                         request.assembly.rays = 128;
                                         request.assembly.storage = storage;
                                         request.solver.solver = Solver::gmres;
                                       }}});
    EXPECT_EQ(said.empty(), storage == Storage::rays) << said;
    EXPECT_TRUE(said.empty() || has(said, "hint: assembly.storage=rays")) << said;
  }
}

TEST(CheckRequest, RefusesASolutionToBeMetBeforeThereIsAMesh) {
  EXPECT_TRUE(has(refusal({{"reference", [](Request& request, Given&) { request.solver.reference = Field(1, 1); }}}),
                  "solver.reference: "));
}

TEST(CheckRequest, KnowsTheNamesOfTheScene) {
  Request request;
  request.accuracy.error_bars = true;
  request.accuracy.interest = {"grey"};
  EXPECT_NO_THROW(check(request, cube_room(0.5, 1)));
  request.accuracy.interest = {"gray"};
  EXPECT_NO_THROW(check(request));
  EXPECT_THROW(check(request, cube_room(0.5, 1)), InputError);
}

// Callers of the library get the error before any work.
TEST(CheckRequest, IsAskedByWhatTakesARequest) {
  Request request;
  request.mesh.max_edge = 1;
  request.mesh.patches = 6;
  const Scene scene = cube_room(0.5, 1);
  EXPECT_THROW(simulate(scene, request), InputError);
  EXPECT_THROW(find_form_factors(scene, request), InputError);
}

// Given form factors exclude a request for the errors of their entries.
TEST(CheckRequest, SeesThatFormFactorsAreGiven) {
  Request request;
  request.accuracy.error_bars = true;
  const Steps steps{.exchange = [](const PatchMesh&) -> Exchange { throw std::logic_error("not to be asked for"); }};
  EXPECT_THROW(simulate(cube_room(0.5, 1), request, {}, steps), InputError);
}

}  // namespace
}  // namespace patchlight::check_request_test
