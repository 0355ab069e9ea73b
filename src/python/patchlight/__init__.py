"""patchlight: lighting simulation for rooms and buildings, with an error bar on every value.

    import patchlight as pl
    scene = pl.read("room.obj", unit="cm")
    scene.materials[0].reflectance = 0.7
    solved = pl.solve(scene, patches=2000)
    solved.illuminance, solved.report()["energy_balance"], solved.write_page("room.html")

Keywords are the options of the command-line tool with _ for -; see patchlight solve --help or help(pl.solve). Lengths are
in meters, except in read(), whose `unit` is that of the model.
"""
import warnings

from patchlight import _core
from patchlight._core import InputError, Material, OutputError, Scene, Simulation, Solution, Transport, solvers
from patchlight.options import OF_GOALS, OF_SOLVING, OF_WRITING, arguments_of, command_of, parted, refuse_unused
from patchlight.transport import sensitivities, sensor_sensitivities
from patchlight import scene as _scene
from patchlight import simulation as _simulation

__version__ = _core.version()
__all__ = ["InputError", "Material", "OutputError", "Scene", "Simulation", "Solution", "Transport", "check", "plan", "read",
           "sensitivities", "sensor_sensitivities", "solve", "solvers", "transport"]


def read(*models, **options):
    """Reads one model, or several as one scene. Options: unit, up, set, only, exclude, simplify, no_merge, sky, sun,
    ground, weather, points (a file of sensors)."""
    refuse_unused("read()", options, OF_WRITING)
    scene = _core.read(arguments_of(models, options))
    for problem in scene.problems:
        if problem["makes_results_wrong"]:
            warnings.warn(problem["what"], stacklevel=2)
    return _scene.remember(scene, models, options)


def check(scene):
    """The problems of a scene, worst first. Raises InputError for scenes that cannot be solved."""
    scene.check()
    return scene.problems


def plan(scene, **options):
    """A dry run of solve(): effects with their reasons, expected patches, seconds and bytes."""
    import json

    refuse_unused("plan()", options, OF_WRITING)
    return json.loads(_core.plan(scene, _arguments(scene, options)))


def _arguments(scene, options):
    """The arguments for a scene that was read, with an equivalent command line as far as there is one."""
    reading, _ = parted(options)
    if reading:
        names = ", ".join(sorted(reading))
        raise InputError(f"found {names}: a scene that is read stays as it is; expected pl.read(FILE, {names.split(',')[0]}=...)")
    arguments = arguments_of([scene.file or "scene"], options)
    arguments.command_line = command_of(scene._models, {**scene._options, **options})
    return arguments


def _progress(show):
    """A function of stage and fraction, and its bar: a tqdm bar for True if installed, else the given function or None."""
    if show is not True:
        return (show if callable(show) else None), None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None, None
    bar = tqdm(total=100, unit="%")

    def tell(stage, share):
        bar.set_description(stage)
        bar.n = round(100 * share)
        bar.refresh()

    return tell, bar


def _read_first(scene, options):
    """The scene, read first if a file is given, and the remaining options."""
    if isinstance(scene, Scene):
        return scene, options
    reading, others = parted(options)
    return read(scene, **reading), others


def _run(work, scene, options, progress, *more):
    tell, bar = _progress(progress)
    try:
        return work(scene, _arguments(scene, options), *more, tell)
    finally:
        if bar is not None:
            bar.close()


def solve(scene, own=None, progress=None, **options):
    """Solves a scene, or a model given by its file name.

    own: a function that replaces the solver. It takes apply (H = F B for arrays of patches x bands), E, rho and H_direct,
    and returns the irradiance H. progress: True for a tqdm bar, or a function of stage and fraction.

    If the solution did not converge or misses accuracy=, Python's warnings.warn() reports it; see also solved.converged
    and solved.notes.

    Options of the tool:

    """
    refuse_unused("solve()", options, OF_WRITING)
    if own is not None:
        refuse_unused("solve(own=...)", options, OF_SOLVING)
    scene, options = _read_first(scene, options)
    changes = _scene.changes(scene)
    if own is not None:
        changes.append(f"solved by {getattr(own, '__name__', 'a function')}() in place of the solver")
    solved = _run(_core.solve, scene, options, progress, own, changes)
    for text in solved._warnings:
        warnings.warn(text, stacklevel=2)
    return solved


def transport(scene, progress=None, **options):
    """Form factors between the patches of a scene with closure, in memory: apply(), operator, form_factors(), and solve()
    with any of patchlight.solvers. Options as for solve(), except those of solver and accuracy."""
    refuse_unused("transport()", options, {**OF_WRITING, **OF_SOLVING, **OF_GOALS})
    return _run(_core.transport, *_read_first(scene, options), progress)


solve.__doc__ += "\n".join("    " + line for line in _core.help("solve").splitlines())
