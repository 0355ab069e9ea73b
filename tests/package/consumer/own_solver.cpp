// A custom solver compared with the library's: Jacobi's iteration, in which every step is a bounce of light.
#include <patchlight/patchlight.h>

using namespace patchlight;

Solution bounce_by_bounce(const RowTransport& transport, const RadiosityProblem& problem, const SolverOptions& options,
                          const Observer&) {
  Solution solution;
  solution.direct_irradiance = transport.apply(problem.exitance);
  solution.radiosity = problem.exitance;
  for (int bounce = 1; bounce <= options.max_iterations && !solution.converged; ++bounce) {
    const Field last = solution.radiosity;
    solution.irradiance = transport.apply(last);
    solution.radiosity = problem.exitance + problem.scattering.reflect(solution.irradiance);
    solution.converged = relative_error(solution.radiosity, last, problem) < tolerance_of(options);
  }
  return solution;
}

int main(int, char** arguments) {
  const Scene scene = read_scene(arguments[1]);
  Request request;
  request.mesh.patches = 100;
  const Simulation usual = simulate(scene, request);
  const Simulation own = simulate(scene, request, {}, {.solve = bounce_by_bounce});
  // The light after the last bounce is at most rho / (1 - rho) times that bounce: nine times for a reflectance of 0.9.
  const double off = relative_error(usual.solution.radiosity, own.solution.radiosity, usual.problem);
  return own.solution.converged && off < 1e-4 ? 0 : 1;
}
