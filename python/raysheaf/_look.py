"""How a scene looks: materials, lights, and the attributes of vertices."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any, Literal, Optional, Sequence, SupportsFloat, SupportsIndex, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _values

Number = Union[SupportsFloat, SupportsIndex]
_SLOTS = ("base_color_texture", "metallic_roughness_texture", "emission_texture", "normal_texture")
_NO_SLOT = {
    "texture": 0xFFFFFFFF,
    "offset": (0.0, 0.0),
    "scale": (1.0, 1.0),
    "rotation": 0.0,
    "second_uvs": False,
}


def _numbers(value: Any, name: str, count: int) -> tuple[float, ...]:
    try:
        numbers = tuple(_values.number(x, name) for x in value)
    except TypeError:
        numbers = ()
    if len(numbers) != count:
        raise ValueError(f"{name}: {value!r} is given; {count} real numbers are expected")
    return numbers


@dataclass
class Material:
    """How a surface looks, in the terms of glTF 2.0: metallic, roughness and their extensions.

    >>> import raysheaf
    >>> raysheaf.Material(base_color=(0.8, 0.1, 0.1), roughness=0.3).metallic
    0.0
    """

    base_color: Sequence[Number] = (1.0, 1.0, 1.0, 1.0)
    """Linear red, green and blue, and alpha where there are four."""
    metallic: Number = 0.0
    roughness: Number = 1.0
    emission: Sequence[Number] = (0.0, 0.0, 0.0)
    """Radiance that it emits."""
    transmission: Number = 0.0
    """The part of light that enters it, as in glass."""
    ior: Number = 1.5
    """Its index of refraction."""
    specular: Number = 1.0
    specular_color: Sequence[Number] = (1.0, 1.0, 1.0)
    alpha_cutoff: Number = 0.0
    """Where alpha is less, there is nothing; 0: alpha is not looked at."""
    alpha_blend: bool = False
    """Alpha is the chance that a ray meets something."""
    thin: bool = False
    """A surface that transmits is a sheet without an inside."""
    unlit: bool = False
    """The base colour is shown as it is."""
    double_sided: bool = True
    """False: cameras do not see its back."""
    normal_scale: Number = 1.0
    """The strength of a normal texture."""
    name: str = ""
    textures: dict[str, dict[str, Any]] = field(default_factory=dict, repr=False)
    """The textures of a file's material, by the names of the factors that they multiply."""

    def _described(self) -> dict[str, Any]:
        """As the extension has materials."""
        described: dict[str, Any] = {"name": _values.text(self.name, "name")}
        color = tuple(self.base_color)
        described["base_color"] = _numbers(
            (*color, 1.0)[:4] if len(color) < 4 else color, "base_color", 4
        )
        for name in ("emission", "specular_color"):
            described[name] = _numbers(getattr(self, name), name, 3)
        for name in ("alpha_blend", "thin", "unlit", "double_sided"):
            described[name] = bool(getattr(self, name))
        for name in (f.name for f in fields(self)):
            if name not in described and name != "textures":
                described[name] = _values.number(getattr(self, name), name)
        for slot in _SLOTS:
            described[slot] = self.textures.get(slot, _NO_SLOT)
        return described


def material_from(described: dict[str, Any]) -> Material:
    """The extension's dictionary as a material."""
    given = {name: value for name, value in described.items() if name not in _SLOTS}
    slots = {n: described[n] for n in _SLOTS if described[n]["texture"] != _NO_SLOT["texture"]}
    return Material(**given, textures=slots)


_TYPES = ("point", "spot", "directional", "rectangle")


@dataclass
class Light:
    """A light, in the terms of glTF's punctual lights, some with a size.

    >>> import raysheaf
    >>> lamp = raysheaf.Light(position=(0, 1.9, 0), intensity=20)
    >>> sun = raysheaf.Light("directional", direction=(-1, -2, -1), intensity=(3, 2.9, 2.5))
    >>> raysheaf.render("builtin:cornell", lights=[lamp, sun], width=32, height=32)
    <raysheaf.Picture 32x32>
    """

    type: Literal["point", "spot", "directional", "rectangle"] = "point"
    position: Sequence[Number] = (0.0, 0.0, 0.0)
    """In the world; a rectangle's centre. Directional lights have none."""
    direction: Sequence[Number] = (0.0, 0.0, -1.0)
    """The way along which light leaves, of any length. Points have none."""
    intensity: Union[Number, Sequence[Number]] = 1.0
    """Candela, or lux of directional lights; one number, or red, green and blue."""
    radius: Number = 0.0
    """The radius of the sphere that shines, for points and spots; 0 gives sharp shadows."""
    range: Number = math.inf
    """Nothing farther is lit."""
    inner_angle: Number = 0.0
    """Degrees from a spot's axis: here its light begins to fade,"""
    outer_angle: Number = 45.0
    """and here it ends."""
    right: Sequence[Number] = (1.0, 0.0, 0.0)
    """A rectangle's direction along its width, square to `direction`."""
    width: Number = 1.0
    height: Number = 1.0
    name: str = ""

    def _described(self) -> dict[str, Any]:
        """As the extension has lights."""
        if self.type not in _TYPES:
            raise ValueError(
                f"type: {self.type!r} is given; one of {', '.join(_TYPES)} is expected"
            )
        intensity: Any = self.intensity
        if np.ndim(intensity) == 0:
            intensity = (intensity,) * 3
        rectangle = self.type == "rectangle"
        return {
            "name": _values.text(self.name, "name"),
            "type": _TYPES.index(self.type),
            "position": _numbers(self.position, "position", 3),
            "direction": _unit(self.direction, "direction"),
            "intensity": _numbers(intensity, "intensity", 3),
            "range": _values.number(self.range, "range"),
            "inner_angle": math.radians(_values.number(self.inner_angle, "inner_angle")),
            "outer_angle": math.radians(_values.number(self.outer_angle, "outer_angle")),
            "radius": _values.number(self.radius, "radius"),
            "right": _unit(self.right, "right"),
            "width": _values.number(self.width, "width") if rectangle else 0.0,
            "height": _values.number(self.height, "height") if rectangle else 0.0,
        }


def light_from(described: dict[str, Any]) -> Light:
    """The extension's dictionary as a light."""
    given = dict(described)
    given["type"] = _TYPES[described["type"]]
    for name in ("inner_angle", "outer_angle"):
        given[name] = math.degrees(described[name])
    return Light(**given)


def _unit(value: Any, name: str) -> tuple[float, ...]:
    numbers = _numbers(value, name, 3)
    length = math.hypot(*numbers)
    if not (math.isfinite(length) and length > 0):
        raise ValueError(f"{name}: {value!r} is given; a vector with a direction is expected")
    if abs(length - 1) < 1e-6:
        return numbers  # those of a file stay as they are
    return tuple(x / length for x in numbers)


@dataclass(frozen=True)
class Surface:
    """The attributes of a mesh's vertices and triangles; None for those that it does not have."""

    name: str = ""
    normals: Optional[NDArray[np.float32]] = None
    """(n, 3), of length 1 or about so."""
    uv: Optional[NDArray[np.float32]] = None
    """(n, 2), texture coordinates; v points down from the top row of images."""
    second_uv: Optional[NDArray[np.float32]] = None
    colors: Optional[NDArray[np.float32]] = None
    """(n, 3), linear."""
    alphas: Optional[NDArray[np.float32]] = None
    materials: Optional[NDArray[np.uint32]] = None
    """Indices into the scene's materials: one a triangle, or a single one."""


def per_vertex(value: Any, name: str, width: int, count: int) -> Optional[NDArray[np.float32]]:
    """A copy of (count, width) floats."""
    if value is None:
        return None
    expected = f"one of shape ({count}, {width})"
    array = _arrays.with_last_axis(value, name, width, expected)
    if array.shape != (count, width):
        raise ValueError(
            f"{name}: an array of shape {array.shape} is given; {expected} is expected, for the mesh "
            f"has {count} vertices"
        )
    with _arrays.rounding():
        return np.array(array, np.float32, order="C")


def surface_of(
    vertices: int,
    triangles: int,
    normals: Optional[ArrayLike],
    uv: Optional[ArrayLike],
    colors: Optional[ArrayLike],
    materials: Optional[NDArray[np.uint32]],
) -> Surface:
    """Checks the attributes of a mesh with so many vertices and triangles."""
    if materials is not None and len(materials) not in (1, triangles):
        raise ValueError(
            f"material: {len(materials)} are given; one, or one for each of {triangles} triangles, is "
            "expected"
        )
    return Surface(
        normals=per_vertex(normals, "normals", 3, vertices),
        uv=per_vertex(uv, "uv", 2, vertices),
        colors=per_vertex(colors, "colors", 3, vertices),
        materials=materials,
    )
