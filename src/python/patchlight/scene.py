"""Materials, changes, copies and text of a scene."""
from patchlight import _core


class Materials(list):
    """The materials of a scene, by index or name."""

    def __getitem__(self, key):
        if not isinstance(key, str):
            return super().__getitem__(key)
        for material in self:
            if material.name == key:
                return material
        raise KeyError(f"found '{key}'; expected one of {', '.join(material.name for material in self)}")

    def __repr__(self):
        return "[" + ", ".join(repr(material) for material in self) + "]"


STATED = ("name", "reflectance", "exitance", "transmittance", "specular_reflectance", "diffuse_transmittance", "index")


def states(scene):
    return [{name: getattr(material, name) for name in STATED} for material in scene.materials]


def remember(scene, models, options):
    """Records the files and options of a scene, and its initial materials."""
    scene._models, scene._options, scene._as_read = models, options, states(scene)
    return scene


def changes(scene):
    """Changes to materials after reading, a sentence for each property."""

    def text(value):
        return ", ".join(repr(float(one)).removesuffix(".0") for one in value) if isinstance(value, list) else str(value)

    return [f"{before['name']}.{name} was set to {text(now[name]) or 'nothing'}"
            for before, now in zip(scene._as_read, states(scene)) for name in STATED if now[name] != before[name]]


def copied(self):
    """A copy of the scene with its own materials."""
    other = _copy(self)
    other._models, other._options, other._as_read = self._models, self._options, self._as_read
    return other


def described(self):
    names = ", ".join(material.name for material in self.materials)
    return f"<patchlight.Scene {self.file}: {self.polygons} polygons; materials {names}>"


_copy = _core.Scene.copy
_core.Scene.copy = copied
_listed = _core.Scene.materials.fget
_core.Scene.materials = property(lambda self: Materials(_listed(self)), doc="The materials, by index or name.")
_core.Scene.__repr__ = described
