"""patchlight: how light bounces between the surfaces of a room, and how far the answer can be trusted.

    import patchlight as pl
    scene = pl.read("room.obj", unit="cm")
    scene.materials[0].reflectance = 0.7
    solved = pl.solve(scene, patches=2000)
    solved.illuminance, solved.report()["energy_balance"], solved.write_page("room.html")

Keywords are the options of the command-line tool with _ for -: patchlight solve --help, or help(pl.solve), has them with
their units. Lengths are metres but in read(), whose `unit` is that of the model.
"""
from patchlight import _core
from patchlight._core import InputError, Material, OutputError, Scene, Simulation, Solution, Transport, solvers
from patchlight.options import arguments_of
from patchlight.transport import sensitivities, sensor_sensitivities
from patchlight import simulation as _simulation

__version__ = _core.version()
__all__ = ["InputError", "Material", "OutputError", "Scene", "Simulation", "Solution", "Transport", "check", "plan", "read",
           "sensitivities", "sensor_sensitivities", "solve", "solvers", "transport"]


def read(*models, **options):
    """Reads one model, or several that together are one scene. Options say how: unit, up, set, only, leave_out, detail,
    keep_faces, sky, sun, ground, weather, points (a file of sensors)."""
    return _core.read(arguments_of(models, options))


def check(scene):
    """What is wrong with a scene, worst first; raises InputError for what cannot be solved."""
    scene.check()
    return scene.problems


def plan(scene, **options):
    """What solve() would do, and why: effects with their reasons, expected patches, seconds and bytes."""
    import json

    return json.loads(_core.plan(scene, arguments_of([scene.file or "scene"], options)))


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


def _run(work, scene, options, progress, *more):
    tell, bar = _progress(progress)
    try:
        return work(scene, arguments_of([scene.file or "scene"], options), *more, tell)
    finally:
        if bar is not None:
            bar.close()


def solve(scene, own=None, progress=None, **options):
    """Solves a scene, or a model by its file's name.

    own: a function in place of the solver; it takes apply (H = F B for arrays of patches x bands), E, rho and H_direct, and
    returns the irradiance H. progress: True for a bar of tqdm, or a function of stage and share.

    Options, as those of the tool:

    """
    return _run(_core.solve, read(scene) if not isinstance(scene, Scene) else scene, options, progress, own)


def transport(scene, progress=None, **options):
    """Form factors between the patches of a scene, closed, kept in memory: apply(), operator, form_factors(), solve() by
    any of patchlight.solvers. Options as of solve()."""
    return _run(_core.transport, read(scene) if not isinstance(scene, Scene) else scene, options, progress)


solve.__doc__ += "\n".join("    " + line for line in _core.help("solve").splitlines())
