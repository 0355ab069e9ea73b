#include "plan/check_request.h"

#include "patchlight/base/error.h"

#include "accuracy/interest.h"

namespace patchlight {
namespace {

// Error bars follow from the errors of stored form factors.
void require_stored_rows(const Request& request) {
  if (keeps_entries(request.storage) || !(request.error_bars || refines(request))) return;
  const std::string other = request.accuracy ? "an accuracy" : request.seconds ? "refining for a time" : "error bars";
  throw InputError("storage", "found rows on demand together with " + other +
                                  "; form factors that are not kept do not tell the errors that this needs; leave one "
                                  "of them out");
}

}  // namespace

void check(const Request& request, const Scene& scene) {
  require_names(scene, request.interest);
  require_stored_rows(request);
}

}  // namespace patchlight
