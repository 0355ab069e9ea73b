"""patchlight: how light bounces between the surfaces of a room, and how far the answer can be trusted.

    import patchlight as pl
    scene = pl.read("room.obj", unit="cm")
    scene.materials[0].reflectance = 0.7
    solved = pl.solve(scene, patches=2000)
    solved.illuminance, solved.report()["energy_balance"], solved.write_page("room.html")

Keywords are the options of the command-line tool with _ for -: patchlight solve --help, or help(pl.solve), has them with
their units. Lengths are metres but in read(), whose `unit` is that of the model.
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
    """Reads one model, or several that together are one scene. Options say how: unit, up, set, only, leave_out, detail,
    keep_faces, sky, sun, ground, weather, points (a file of sensors)."""
    refuse_unused("read()", options, OF_WRITING)
    scene = _core.read(arguments_of(models, options))
    for problem in scene.problems:
        if problem["makes_results_wrong"]:
            warnings.warn(problem["what"], stacklevel=2)
    return _scene.remember(scene, models, options)


def check(scene):
    """What is wrong with a scene, worst first; raises InputError for what cannot be solved."""
    scene.check()
    return scene.problems


def plan(scene, **options):
    """What solve() would do, and why: effects with their reasons, expected patches, seconds and bytes."""
    import json

    refuse_unused("plan()", options, OF_WRITING)
    return json.loads(_core.plan(scene, _arguments(scene, options)))


def _arguments(scene, options):
    """Those of a scene that is there, with the command line that says most of what is done."""
    reading, _ = parted(options)
    if reading:
        names = ", ".join(sorted(reading))
        raise InputError(f"found {names}: a scene that is read stays as it is; expected pl.read(FILE, {names.split(',')[0]}=...)")
    arguments = arguments_of([scene.file or "scene"], options)
    arguments.command_line = command_of(scene._models, {**scene._options, **options})
    return arguments


def _progress(show):
    """A function of stage and share: a bar of tqdm where it is there and wanted, else what the user gives, else None."""
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
    """A scene, which is read where a file is named, and the options that are left."""
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
    """Solves a scene, or a model by its file's name.

    own: a function in place of the solver; it takes apply (H = F B for arrays of patches x bands), E, rho and H_direct, and
    returns the irradiance H. progress: True for a bar of tqdm, or a function of stage and share.

    A solution that has not converged, or is less accurate than accuracy= asks for, is a warning of Python's
    warnings.warn(); solved.converged and solved.notes have the same to read.

    Options, as those of the tool:

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
    """Form factors between the patches of a scene, closed, kept in memory: apply(), operator, form_factors(), solve() by
    any of patchlight.solvers. Options as of solve(), but for those of its solver and its goal."""
    refuse_unused("transport()", options, {**OF_WRITING, **OF_SOLVING, **OF_GOALS})
    return _run(_core.transport, *_read_first(scene, options), progress)


solve.__doc__ += "\n".join("    " + line for line in _core.help("solve").splitlines())
