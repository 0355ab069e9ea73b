#include "output/report/write_plan.h"

#include "patchlight/output/provenance.h"

#include "output/file/write_bytes.h"
#include "output/report/decisions_part.h"
#include "output/report/json_array.h"

#include <nlohmann/json.hpp>

namespace patchlight {

std::string plan_json(const Scene& scene, const Plan& plan, const ExpectedCost& cost) {
  nlohmann::ordered_json json;
  json["version"] = version();
  json["file"] = scene.file;
  json["sha256"] = scene.sha256;
  json["polygons"] = scene.polygons.size();
  json["max_edge_m"] = plan.max_edge;
  json["storage"] = name_of(plan.assembly.storage);
  json["solver"] = name_of(plan.solver.solver);
  json["decisions"] = decisions_part(plan.decisions);
  json["expected"] = {{"patches", cost.patches},
                      {"memory_bytes", cost.bytes},
                      {"of_first_mesh", cost.of_first_mesh},
                      {"threads", cost.threads},
                      {"seconds", cost.seconds()},
                      {"form_factor_cpu_seconds", cost.form_factor_seconds},
                      {"direct_light_cpu_seconds", cost.direct_light_seconds},
                      {"solve_cpu_seconds", cost.solve_seconds},
                      {"sensors", cost.sensors},
                      {"sensor_cpu_seconds", cost.sensor_seconds}};
  json["sides_notes"] = json_of(plan.sides.notes);
  json["notes"] = json_of(plan.notes);
  json["scene_warnings"] = json_of(chosen(scene.diagnostics, makes_results_wrong));
  json["scene_notes"] = json_of(remarks_of(scene));
  // Names from a model may hold bytes that are not UTF-8: they are replaced.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void write_plan(const std::filesystem::path& file, const Scene& scene, const Plan& plan, const ExpectedCost& cost) {
  write_bytes(file, plan_json(scene, plan, cost));
}

}  // namespace patchlight
