#include "plan/memory.h"

#include "patchlight/base/error.h"
#include "patchlight/scene/sides.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <unistd.h>

namespace patchlight {
namespace {

// The exchange areas, in float, half of a symmetric matrix. The rest is measured: what the program and its libraries
// take, and the mesh, the fields and the results per patch.
constexpr double bytes_per_pair = 2;
constexpr double bytes_per_error = 0.5;   // standard errors, where they are wanted: one byte for two entries
constexpr double bytes_of_parents = 0.7;  // with error bars: the matrix of the parents while it is summed up
constexpr double bytes_while_refining =
    5.5;  // another matrix before closure, and at the end of a mesh that of the next
constexpr double bytes_per_patch = 1500;
constexpr double bytes_of_coarse_transport = 300;  // per patch, what progressive refinement has learned from rows
constexpr double bytes_of_program = 50e6;

// Share of the machine's memory that may be taken when nothing is said.
constexpr double usable_share = 0.8;

// What memory follows from beside the number of patches.
struct Holding {
  const Request& request;
  Storage storage;
};

Holding holding(const Request& request) { return {request, request.storage}; }
Holding holding(const Request& request, const Plan& plan) { return {request, plan.storage}; }

double bytes_of_a_pair(const Holding& holding) {
  if (!keeps_entries(holding.storage)) return 0;
  if (refines(holding.request)) return bytes_per_pair + bytes_while_refining;
  if (holding.request.error_bars) return 2 * bytes_per_pair + bytes_per_error + bytes_of_parents;
  return bytes_per_pair + (holding.request.standard_errors ? bytes_per_error : 0);
}

double bytes_of_a_patch(const Holding& holding) {
  return bytes_per_patch + (keeps_entries(holding.storage) ? 0 : bytes_of_coarse_transport);
}

double installed_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

// The number of patches at first.
std::size_t patches_asked(const Request& request) {
  return request.patches.value_or(refines(request) ? first_patches : default_patches);
}

// The number of patches for which memory_needed() is this.
double patches_in(double bytes, const Holding& holding) {
  const double left = std::max(0.0, bytes - bytes_of_program);
  const double of_a_pair = bytes_of_a_pair(holding);
  if (of_a_pair == 0) return std::max(1.0, left / bytes_of_a_patch(holding));
  const double half = bytes_of_a_patch(holding) / (2 * of_a_pair);
  return std::max(1.0, std::sqrt(half * half + left / of_a_pair) - half);
}

double memory_needed(std::size_t patches, const Holding& holding) {
  const auto n = static_cast<double>(patches);
  return bytes_of_a_pair(holding) * n * n + bytes_of_a_patch(holding) * n + bytes_of_program;
}

void require_memory(std::size_t patches, const Holding& holding) {
  const Request& request = holding.request;
  const double needed = memory_needed(patches, holding);
  const double usable = usable_memory(request);
  if (needed <= usable) return;
  const auto fitting = static_cast<long>(patches_in(usable, holding));
  // Small faces take a patch each, however few are asked for.
  const bool too_many_faces = !request.max_edge && static_cast<long>(patches_asked(request)) <= fitting;
  const std::string hint =
      usable <= 2 * bytes_of_program ? "the program itself takes " + gigabytes(bytes_of_program)
      : too_many_faces
          ? "fewer cannot be had, as its faces alone take so many: simplify the model, or leave objects out"
          : "ask for at most " + std::to_string(fitting) + " patches with --patches";
  throw MemoryError(std::to_string(patches) + " patches need about " + gigabytes(needed) +
                    (keeps_entries(holding.storage) ? ", most of it for their form factors, and " : ", and ") +
                    gigabytes(usable) + (request.memory ? " may be taken (--memory); " : " may be taken here; ") +
                    hint);
}

// By the number of patches that is asked for, or the least number that an edge allows.
void require_memory(const Scene& scene, const Holding& holding) {
  const Request& request = holding.request;
  if (!request.max_edge) return require_memory(patches_asked(request), holding);
  const double largest = *request.max_edge * *request.max_edge;
  const double least = kept_area(scene, sides_for(scene, request)) / largest;
  // Too many to count are as good as the largest number.
  require_memory(static_cast<std::size_t>(std::min(least, 1e18)), holding);
}

}  // namespace

std::string gigabytes(double bytes) {
  std::ostringstream text;
  text << std::setprecision(3) << bytes / 1e9 << " GB";
  return text.str();
}

double usable_memory(const Request& request) {
  return request.memory ? *request.memory : usable_share * installed_bytes();
}

double patches_that_fit(const Request& request) { return patches_in(usable_memory(request), holding(request)); }

double memory_needed(std::size_t patches, const Request& request) { return memory_needed(patches, holding(request)); }

double memory_needed(std::size_t patches, const Request& request, const Plan& plan) {
  return memory_needed(patches, holding(request, plan));
}

void require_memory(std::size_t patches, const Request& request) { require_memory(patches, holding(request)); }

void require_memory(std::size_t patches, const Request& request, const Plan& plan) {
  require_memory(patches, holding(request, plan));
}

void require_memory(const Scene& scene, const Request& request) { require_memory(scene, holding(request)); }

void require_memory(const Scene& scene, const Request& request, const Plan& plan) {
  require_memory(scene, holding(request, plan));
}

}  // namespace patchlight
