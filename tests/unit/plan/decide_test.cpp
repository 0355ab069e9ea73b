#include "plan/decide.h"

#include <gtest/gtest.h>
#include <stdexcept>

namespace patchlight::decide_test {
namespace {

// A typical room: it contains furniture, it reflects, and so do its colors. One lamp.
EffectFacts usual_facts() {
  EffectFacts facts;
  facts.polygons = 12;
  facts.inside_hull = 6;
  facts.highest_reflectance = 0.5;
  facts.bands = 3;
  facts.lamps = 1;
  return facts;
}

Decision decision(const EffectFacts& facts, Effect effect, const Request& request = {}) {
  for (const Decision& candidate : decide(facts, request)) {
    if (candidate.effect == effect) return candidate;
  }
  throw std::out_of_range(name_of(effect));
}

bool is_on(const EffectFacts& facts, Effect effect, const Request& request = {}) {
  return decision(facts, effect, request).simulate;
}

TEST(Decide, DecidesOnEveryEffectThatCanBeSimulated) {
  const std::vector<Decision> decisions = decide(usual_facts(), {});
  for (const Effect effect : simulated_effects()) {
    EXPECT_NO_THROW(decision(usual_facts(), effect)) << name_of(effect);
  }
  EXPECT_EQ(decisions.size(), simulated_effects().size()) << "and on no other";
  for (const Decision& each : decisions) {
    EXPECT_FALSE(each.reason.empty()) << name_of(each.effect);
    EXPECT_FALSE(each.saving.empty()) << name_of(each.effect);
    EXPECT_FALSE(each.forced);
  }
}

TEST(Decide, OcclusionWhereSomethingCanStandBetween) {
  EffectFacts facts = usual_facts();
  EXPECT_TRUE(is_on(facts, Effect::occlusion));
  facts.inside_hull = 0;
  EXPECT_FALSE(is_on(facts, Effect::occlusion));
}

TEST(Decide, InterreflectionAndClosureWhereSomethingReflects) {
  EffectFacts facts = usual_facts();
  EXPECT_TRUE(is_on(facts, Effect::interreflection));
  EXPECT_TRUE(is_on(facts, Effect::closure));
  facts.highest_reflectance = 0;
  EXPECT_FALSE(is_on(facts, Effect::interreflection));
  EXPECT_FALSE(is_on(facts, Effect::closure));
}

// 0.5^n <= 1e-6 for n >= 19.93.
TEST(Decide, TellsHowManyBouncesTheAskedErrorTakes) {
  EXPECT_NE(decision(usual_facts(), Effect::interreflection).saving.find("after 20 bounces"), std::string::npos);
}

TEST(Decide, ColourUnlessSurfacesAreGreyAndLightsAreOfOneColour) {
  EffectFacts facts = usual_facts();
  EXPECT_TRUE(is_on(facts, Effect::colour));
  facts.grey = true;
  EXPECT_TRUE(is_on(facts, Effect::colour)) << "lamps differ";
  facts.lamp_colour = rgb(1, 0.8, 0.6);
  EXPECT_FALSE(is_on(facts, Effect::colour));
  facts.grey = false;
  EXPECT_TRUE(is_on(facts, Effect::colour)) << "surfaces differ";
  facts.dark_bands = {1};
  EXPECT_NE(decision(facts, Effect::colour).reason.find("band 2 without light"), std::string::npos);
}

TEST(Decide, ReachAndBacksWhereSidesAreLeftOut) {
  EffectFacts facts = usual_facts();
  EXPECT_TRUE(is_on(facts, Effect::reach));
  EXPECT_TRUE(is_on(facts, Effect::backs));
  facts.dark_solids = {{"'attic' (house.obj:12)", 6}};
  facts.unreached = 6;
  facts.turned_away = 6;
  EXPECT_FALSE(is_on(facts, Effect::reach));
  EXPECT_NE(decision(facts, Effect::reach).reason.find("'attic' (house.obj:12)"), std::string::npos);
  EXPECT_FALSE(is_on(facts, Effect::backs));
  Request front;
  front.mesh.sides = Sides::front;
  EXPECT_TRUE(is_on(facts, Effect::reach, front)) << "the user has chosen";
}

TEST(Decide, LightsOnlyWhereTheyAre) {
  EffectFacts facts = usual_facts();
  for (const Effect light : {Effect::luminaires, Effect::sun, Effect::sky}) EXPECT_FALSE(is_on(facts, light));
  facts.luminaires = 2;
  facts.sun_altitude = 30;
  facts.sky = true;
  for (const Effect light : {Effect::luminaires, Effect::sun, Effect::sky}) EXPECT_TRUE(is_on(facts, light));
  facts.sun_altitude = -1;
  EXPECT_FALSE(is_on(facts, Effect::sun));
  EXPECT_TRUE(is_on(facts, Effect::sky)) << "it glows after sunset";
}

TEST(Decide, DaylightOnlyWhereSomethingSeesOut) {
  EffectFacts facts = usual_facts();
  facts.sun_altitude = 30;
  facts.sky = true;
  facts.sees_out = false;
  EXPECT_FALSE(is_on(facts, Effect::sun));
  EXPECT_FALSE(is_on(facts, Effect::sky));
  facts.openings = 1;
  EXPECT_TRUE(is_on(facts, Effect::sun));
  EXPECT_TRUE(is_on(facts, Effect::sky));
}

TEST(Decide, NamesWhatIsNotSimulatedOnlyWhereItIs) {
  EffectFacts facts = usual_facts();
  for (const Effect effect : {Effect::bands_of_panes, Effect::gloss, Effect::glass}) {
    EXPECT_THROW(decision(facts, effect), std::out_of_range);
  }
  facts.gloss = 2;
  facts.glass = 1;
  for (const auto& [effect, count] : {std::pair{Effect::gloss, "2"}, {Effect::glass, "1"}}) {
    EXPECT_FALSE(is_on(facts, effect));
    EXPECT_NE(decision(facts, effect).reason.find(std::string("not simulated: ") + count), std::string::npos);
  }
}

TEST(Decide, TellsColoursOfPanesApartByRays) {
  EffectFacts facts = usual_facts();
  facts.coloured_specular = 1;
  const Decision decided = decision(facts, Effect::bands_of_panes);
  EXPECT_TRUE(decided.simulate);
  EXPECT_NE(decided.reason.find(" 1 "), std::string::npos) << decided.reason;
}

TEST(Decide, ObeysTheRequestAndMarksIt) {
  Request request;
  request.effects.skip = {Effect::occlusion};
  const Decision skipped = decision(usual_facts(), Effect::occlusion, request);
  EXPECT_FALSE(skipped.simulate);
  EXPECT_TRUE(skipped.forced);
  EXPECT_TRUE(sentence(skipped).starts_with("occlusion: ")) << sentence(skipped);
  EXPECT_NE(sentence(skipped).find("6 of 12"), std::string::npos) << sentence(skipped);

  EffectFacts convex = usual_facts();
  convex.inside_hull = 0;
  EXPECT_FALSE(decision(convex, Effect::occlusion, request).forced) << "the facts say so, too";
  request.effects.skip = {};
  request.effects.force = {Effect::occlusion};
  EXPECT_TRUE(decision(convex, Effect::occlusion, request).simulate);
  EXPECT_TRUE(decision(convex, Effect::occlusion, request).forced);
}

TEST(Decide, CannotForceWhatIsNotThere) {
  Request request;
  request.effects.force = {Effect::sun, Effect::sky, Effect::luminaires};
  for (const Effect light : request.effects.force) {
    EXPECT_FALSE(is_on(usual_facts(), light, request));
    EXPECT_FALSE(decision(usual_facts(), light, request).forced);
  }
}

TEST(Decide, ClosureFollowsItsOptions) {
  Request request;
  request.assembly.close = false;
  EXPECT_TRUE(decision(usual_facts(), Effect::closure, request).forced);
  EXPECT_FALSE(is_on(usual_facts(), Effect::closure, request));
  request.assembly.close = true;
  request.assembly.storage = Storage::on_demand;
  EXPECT_FALSE(is_on(usual_facts(), Effect::closure, request));
  request.assembly.storage = Storage::tiles;
  request.effects.skip = {Effect::interreflection};
  EXPECT_FALSE(is_on(usual_facts(), Effect::closure, request)) << "it cannot matter any more";
  request.effects.force = {Effect::closure};
  EXPECT_TRUE(is_on(usual_facts(), Effect::closure, request));
}

}  // namespace
}  // namespace patchlight::decide_test
