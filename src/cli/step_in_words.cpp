#include "cli/step_in_words.h"

#include "base/rounded.h"

#include <cmath>

namespace patchlight::cli {
namespace {

// Where no bound on it is known, the error does not have it.
std::string solver_in_words(const AccuracyStep& step) {
  return std::isfinite(step.solver) ? percent(step.solver, 1) : "not known and not in it";
}

// The parts of the error, each in percent.
std::string parts(const AccuracyStep& step) {
  return "mesh " + percent(step.mesh, 2) + ", form factors " + percent(step.form_factor, 2) + ", solver " +
         solver_in_words(step);
}

}  // namespace

double known_error(const AccuracyStep& step) {
  return std::isfinite(step.solver) ? step.total : std::hypot(step.mesh, step.form_factor);
}

std::string errors_in_words(const AccuracyStep& step) {
  return percent(known_error(step), 2) + " %: " + parts(step) + "; points within a patch differ from its mean by " +
         percent(step.display, 2) + " %, which shows where each patch is drawn in one even colour";
}

std::string step_in_words(const AccuracyStep& step) {
  return std::to_string(step.patches) + " patches, " + percent(known_error(step), 2) + " % (" + parts(step) + "), " +
         rounded(step.seconds) + " s";
}

}  // namespace patchlight::cli
