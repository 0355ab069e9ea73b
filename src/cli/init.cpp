#include "patchlight/base/error.h"

#include "cli/commands.h"
#include "cli/init_places.h"
#include "cli/interrupt.h"
#include "cli/messages.h"
#include "output/file/whole_file.h"
#include "plan/survey.h"

#include <iostream>
#include <system_error>

namespace patchlight::cli {

ExitCode init(const InitArguments& arguments) {
  std::error_code error;
  if (std::filesystem::exists(arguments.output, error))
    throw OutputError(arguments.output.string(), "already exists\nhint: choose another name, or delete it");
  check_writable(arguments.output);
  const Scene scene = read_scene(arguments.models, arguments.read);
  for (const Diagnostic& problem : problems_with_size(scene)) print_diagnostic("note", problem);
  const NewLight light = new_light(scene);
  const TriedPlaces tried = new_places(with_new_light(scene, light));
  for (const Diagnostic& note : tried.notes) print_diagnostic("note", note);
  const std::string text =
      new_scene_file(scene, light, tried.places, arguments.models, arguments.read.metres_per_unit, arguments.output);
  const WritingGuard guard;
  write_bytes(arguments.output, text);
  std::cout << "wrote " << arguments.output.string() << "; next: patchlight solve " << arguments.output.string()
            << " -o result.vtp --json result.json --picture result.png\n"
            << std::flush;
  return good;
}

}  // namespace patchlight::cli
