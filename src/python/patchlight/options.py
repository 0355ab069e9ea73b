"""Keywords of Python as options of the command line: max_edge=0.1 is --max-edge 0.1."""
import shlex

from patchlight import _core


def words_of(command, models, options):
    """The words of a command line. True gives a flag, False and None give nothing, a list repeats its option."""
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


# Options whose one value has commas in it.
TRIPLES = {"up", "size"}


# Options that say how a model is read and lit: read() takes them.
OF_READING = {"format", "unit", "confine", "up", "set", "only", "exclude", "leave_out", "simplify", "detail", "no_merge", "keep_faces", "maintenance_factor", "bands",
              "color_error", "sky", "sun", "ground", "weather", "points"}


# What these ask for is a method here: hint for each.
OF_WRITING = {
    **dict.fromkeys(("o", "output", "ambient_occlusion"), "solved.write(FILE)"),
    "html": "solved.write_page(FILE)",
    **dict.fromkeys(("json", "report"), "solved.report()"),
    **dict.fromkeys(("picture", "camera", "projection", "view", "size", "picture_quality", "quality", "false_color", "picture_error",
                     "picture_samples", "picture_error_map"), "solved.picture(...)"),
    **dict.fromkeys(("points_output", "map", "map_range"), "solved.sensors()"),
    **dict.fromkeys(("series", "lightmap", "texel", "form_factors", "checkpoint", "discard", "quiet", "verbose", "q", "v"),
                    "the tool patchlight"),
}

# A transport has no solver until its method solve() is called, and no goal.
OF_SOLVING = dict.fromkeys(("solver", "tolerance", "max_iterations", "relaxation", "max_rows"), "transport.solve(NAME, ...)")
OF_GOALS = dict.fromkeys(("accuracy", "time_limit", "time", "focus", "interest", "no_refine", "keep_mesh", "error_bars", "no_error_bars"), "pl.solve(...)")


def refuse_unused(call, options, unused):
    """Raises InputError for options that a call would not use: `unused` has their names, and what has them instead."""
    for name in options:
        instead = unused.get(name.rstrip("_"))
        if instead is not None:
            raise _core.InputError(f"{name}: found an option that {call} does not use; expected it in {instead}")


def parted(options):
    """Those of reading, and the others."""
    reading = {name: value for name, value in options.items() if name.rstrip("_") in OF_READING}
    return reading, {name: value for name, value in options.items() if name not in reading}


def command_of(models, options):
    """The command line that does the same, as far as one can."""
    return shlex.join(words_of("solve", models, options))


def arguments_of(models, options):
    """The options of patchlight solve, understood or refused as there."""
    # Something has to be written there; here it is returned.
    return _core.parse(words_of("solve", models, options) + ["--json", "unwritten.json"])


def picture_arguments_of(options):
    """Those of a picture."""
    options = dict(options)
    camera = options.pop("camera", None)
    words = words_of("solve", ["scene"], options) + ["--picture", "unwritten.png"]
    if camera is not None:
        eye, target, field_of_view = camera
        words += ["--camera", *(",".join(map(str, place)) for place in (eye, target)), str(field_of_view)]
    return _core.parse(words)
