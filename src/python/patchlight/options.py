"""Keywords of Python as options of the command line: max_edge=0.1 is --max-edge 0.1."""
import shlex

from patchlight import _core


def words_of(command, models, options):
    """The words of a command line. True gives a flag, False and None nothing; a list repeats its option."""
    words = ["patchlight", command, *map(str, models)]
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, (list, tuple)) and name not in TRIPLES:
            for one in value:
                words += [option, str(one)]
        else:
            words += [option, ",".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)]
    return words


# Options with a single value that contains commas.
TRIPLES = {"up", "size"}


# Options of read(): reading and lighting a model.
OF_READING = {"format", "unit", "confine", "up", "set", "only", "exclude", "leave_out", "simplify", "detail", "no_merge", "keep_faces", "maintenance_factor", "bands",
              "color_error", "sky", "sun", "ground", "weather", "points"}


# Python has a method instead of each of these options.
OF_WRITING = {
    **dict.fromkeys(("o", "output", "ambient_occlusion"), "solved.write(FILE)"),
    "html": "solved.write_page(FILE)",
    **dict.fromkeys(("json", "report"), "solved.report()"),
    **dict.fromkeys(("picture", "camera", "projection", "view", "size", "picture_quality", "quality", "exposure", "false_color", "picture_error",
                     "picture_samples", "picture_error_map"), "solved.picture(...)"),
    **dict.fromkeys(("points_output", "map", "map_range"), "solved.sensors()"),
    **dict.fromkeys(("series", "lightmap", "texel", "form_factors", "checkpoint", "discard", "quiet", "verbose", "q", "v"),
                    "the tool patchlight"),
}

# A transport has no solver until its method solve() is called, and no target accuracy.
OF_SOLVING = dict.fromkeys(("solver", "tolerance", "max_iterations", "relaxation", "max_rows"), "transport.solve(NAME, ...)")
OF_GOALS = dict.fromkeys(("accuracy", "time_limit", "time", "focus", "interest", "no_refine", "keep_mesh", "error_bars", "no_error_bars"), "pl.solve(...)")


def refuse_unused(call, options, unused):
    """Raises InputError for options that a call does not use. `unused` maps their names to the call that uses them."""
    for name in options:
        instead = unused.get(name.rstrip("_"))
        if instead is not None:
            raise _core.InputError(f"{name}: found an option that {call} does not use; expected it in {instead}")


def parted(options):
    """The reading options, and the others."""
    reading = {name: value for name, value in options.items() if name.rstrip("_") in OF_READING}
    return reading, {name: value for name, value in options.items() if name not in reading}


def command_of(models, options):
    """The equivalent command line, as far as there is one."""
    return shlex.join(words_of("solve", models, options))


def arguments_of(models, options):
    """The arguments of patchlight solve, parsed by its rules."""
    # The tool requires an output; nothing is written here.
    return _core.parse(words_of("solve", models, options) + ["--json", "unwritten.json"])


def picture_arguments_of(options):
    """The arguments of an image."""
    options = dict(options)
    camera = options.pop("camera", None)
    words = words_of("solve", ["scene"], options) + ["--picture", "unwritten.png"]
    if camera is not None:
        eye, target, field_of_view = camera
        words += ["--camera", *(",".join(map(str, place)) for place in (eye, target)), str(field_of_view)]
    return _core.parse(words)
