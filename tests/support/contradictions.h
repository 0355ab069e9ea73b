#pragma once

#include "patchlight/plan/plan.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

// Parts of requests that are valid alone, and the pairs of them that exclude each other.
namespace patchlight::test {

struct RequestPart {
  std::string name;  ///< as in messages
  std::function<void(Request&, Given&)> ask;
};

inline std::vector<RequestPart> request_parts() {
  const auto by_shooting = [](Request& request) -> Request& {
    request.solver.solver = Solver::progressive;
    return request;
  };
  const auto part = [](std::string name, const std::function<void(Request&)>& ask) {
    return RequestPart{std::move(name), [ask](Request& request, Given&) { ask(request); }};
  };
  const auto force = [part](Effect effect) {
    return part(std::string("effects.force=") + name_of(effect),
                [effect](Request& r) { r.effects.force.push_back(effect); });
  };
  const auto skip = [part](Effect effect) {
    return part(std::string("effects.skip=") + name_of(effect),
                [effect](Request& r) { r.effects.skip.push_back(effect); });
  };
  return {part("mesh.max_edge", [](Request& r) { r.mesh.max_edge = 1; }),
          part("mesh.patches", [](Request& r) { r.mesh.patches = 100; }),
          part("mesh.sides=both", [](Request& r) { r.mesh.sides = Sides::both; }),
          part("mesh.kept_sides", [](Request& r) { r.mesh.kept_sides.emplace(); }),
          force(Effect::reach),
          skip(Effect::backs),
          force(Effect::occlusion),
          force(Effect::sun),
          skip(Effect::sun),
          force(Effect::closure),
          skip(Effect::closure),
          skip(Effect::interreflection),
          part("assembly.close=false", [](Request& r) { r.assembly.close = false; }),
          part("assembly.storage=on_demand", [=](Request& r) { by_shooting(r).assembly.storage = Storage::on_demand; }),
          part("assembly.storage=rays",
               [](Request& r) {
                 r.assembly.storage = Storage::rays;
                 r.solver.solver = Solver::gmres;
               }),
          part("assembly.estimator=area", [](Request& r) { r.assembly.estimator = Estimator::area; }),
          part("assembly.short_cuts", [](Request& r) { r.assembly.short_cuts.far = false; }),
          part("assembly.samples", [](Request& r) { r.assembly.samples = 64; }),
          part("assembly.keep_errors", [](Request& r) { r.assembly.keep_errors = true; }),
          part("solver.max_rows", [=](Request& r) { by_shooting(r).solver.max_rows = 0.1; }),
          part("accuracy.error_bars", [](Request& r) { r.accuracy.error_bars = true; }),
          part("accuracy.relative_error", [](Request& r) { r.accuracy.relative_error = 0.01; }),
          part("accuracy.seconds", [](Request& r) { r.accuracy.seconds = 1; }),
          {"given.mesh", [](Request&, Given& given) { given.mesh = true; }},
          {"given.form_factors", [](Request&, Given& given) { given.form_factors = true; }}};
}

/// Every part with the parts that it excludes.
inline std::vector<std::pair<std::string, std::vector<std::string>>> exclusive_parts() {
  const std::vector<std::string> bars = {"accuracy.error_bars", "accuracy.relative_error", "accuracy.seconds"};
  const auto and_bars = [&](std::vector<std::string> others) {
    others.insert(others.end(), bars.begin(), bars.end());
    return others;
  };
  return {
      {"mesh.max_edge", {"mesh.patches"}},
      {"mesh.sides=both", {"effects.force=reach", "effects.skip=backs"}},
      {"mesh.kept_sides", {"effects.force=reach", "effects.skip=backs"}},
      {"effects.force=sun", {"effects.skip=sun"}},
      {"effects.force=closure", {"effects.skip=closure", "assembly.close=false", "assembly.storage=on_demand"}},
      {"assembly.storage=on_demand", and_bars({"assembly.close=false", "assembly.estimator=area"})},
      {"assembly.storage=rays",
       {"effects.force=closure", "effects.skip=closure", "assembly.close=false", "assembly.estimator=area",
        "assembly.short_cuts", "assembly.keep_errors", "assembly.samples", "solver.max_rows", "given.form_factors"}},
      {"assembly.estimator=area", and_bars({"assembly.short_cuts", "assembly.keep_errors"})},
      {"given.form_factors", and_bars({"effects.force=occlusion", "assembly.storage=on_demand"})},
      {"given.mesh", bars},
      {"assembly.close=false", bars},
      {"effects.skip=closure", bars},
      {"effects.skip=interreflection", bars},
      {"solver.max_rows", bars}};
}

}  // namespace patchlight::test
