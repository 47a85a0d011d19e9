# SPDX-License-Identifier: Apache-2.0
"""What light, and blocks of which colours and materials, explain the colours of a scene.

In linear light, a surface of colour b that diffuses the light shows E·(b + s)·L: the light L is
that of the scene, the shade E about that of its other blocks, and a little sheen s of the light is
mirrored at its surface. Metal has no sheen of the light's colour. An upright wall of it mirrors the
table before it, tinted by its own colour: E·b·T, where E is about the brightness of that table and
T its colour. So on a dark table metal is darker than all else, and orange metal no brown paint.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from tamp_runtime.machine_code import address, written

from scene_graph import COLORS

Array = NDArray[np.float64]
Real = NDArray[np.float32]

_NAMES: Final = tuple(COLORS)
#: Light is about this power of its code in a picture.
_GAMMA: Final = 2.2
#: Brightness that a surface may have, as a code relative to the colour's own, in equal ratios.
_SHADES: Final = np.geomspace(0.25, 1.4, 20)
_STEP: Final = float(np.log(_SHADES[1] / _SHADES[0]))
#: What a surface mirrors of white light, and the cost of it [ΔE²].
_SHEEN: Final = (0.0, 0.006, 0.012, 0.02, 0.03)
_SHEEN_COST: Final = (0.0, 4.0, 8.0, 16.0, 32.0)
#: Cost of a block's shade that differs from the scene's, per squared logarithm [ΔE²].
_OWN_SHADE_COST: Final = 1600.0
#: Cost of a scene's shade that differs from the usual one, per squared logarithm [ΔE²].
_SCENE_SHADE_COST: Final = 100.0
_USUAL_SHADE: Final = 0.8
#: Cost of a block of metal, and of its shade that differs from what it mirrors: so much of the
#: table's light and, as it is rough, a little of the room's [ΔE²].
_METAL_COST: Final = 20.0
_METAL_SHADE_COST: Final = 600.0
_OF_TABLE: Final = 0.95
_OF_ROOM: Final = 0.11
#: It mirrors no more than so much of the table's colour: none, half, all of it.
_OF_TINT: Final = (0.0, 0.5, 1.0)
#: Colour of the light: gains of red and of blue over green, in equal ratios, and the cost of
#: one that is not 1, per squared logarithm [ΔE²].
_GAINS: Final = np.exp(np.linspace(-0.42, 0.42, 7))
#: And finer, about the best of those.
_FINER_GAINS: Final = np.exp(np.linspace(-0.1, 0.1, 5))
_GAIN_COST: Final = 400.0
#: White light that explains all colours to this [ΔE] is not asked further.
_WHITE_ENOUGH: Final = 5.0
#: if they are so many: of fewer, the light and the names can be mistaken for one another.
_ENOUGH: Final = 3
#: A block of no known colour says nothing of the light beyond this cost [ΔE²].
_MOST_COST: Final = 150.0
#: Daylight and lamps are cool or warm: red rises as blue falls. From the logarithms of both gains
#: how warm a light is, and how far beside those, shape (2, 2); of most lights it is at most this.
_WARMTH: Final = np.array([[0.53, -0.85], [0.85, 0.53]])
_USUAL_LIGHT: Final = np.array([0.3, 0.11])
#: Colours are compared as if each were as bright as this, by one of these gains, so that dark ones
#: are told apart as well as bright ones are.
_BRIGHTNESS: Final = 0.2
_LEVELS: Final = np.geomspace(0.5, 4.0, 7)
_LUMINANCE: Final = np.array([0.3, 0.5, 0.2])
#: A colour is not named that is further than this from all names, or not nearer by this to its own
#: than to the next one [ΔE].
MAX_DISTANCE: Final = 7.5
MIN_MARGIN: Final = 5.0
#: Two blocks whose paints are between two colours look as plain ones do in a strange light. Where
#: such a light explains a scene best, a block of no known colour costs no more than this, that one
#: at the greatest distance has the least margin, so that names have to be better than none [ΔE²].
_MOST_COST_IF_STRANGE: Final = MAX_DISTANCE**2 + MIN_MARGIN**2

_XYZ_FROM_RGB: Final = np.array(
    [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
)
_WHITE_XYZ: Final = _XYZ_FROM_RGB.sum(axis=1)
_FILE: Final = Path(__file__).with_suffix(".c")


@dataclass(frozen=True)
class ColorFit:
    """How the colours of N blocks are explained, all lit by one light.

    Attributes:
        names: the nearest of ``scene_graph.COLORS`` for each.
        others: the next nearest.
        distances: from the nearest, shape (N,) [ΔE].
        margins: by how much the next one is further away, in this light and in those by which all
            blocks together are explained about as well, shape (N,) [ΔE].
        light: its colour, gains of red, green and blue.
        gaps: by how much each of ``scene_graph.COLORS`` is further away than the nearest, in the
            same lights, shape (N, names) [ΔE].
    """

    names: tuple[str, ...]
    others: tuple[str, ...]
    distances: Array
    margins: Array
    light: Array
    gaps: Array

    @property
    def known(self) -> NDArray[np.bool_]:
        """Which colours have a name, shape (N,)."""
        return np.asarray(self.distances <= MAX_DISTANCE)


def color_names(colors: Array) -> tuple[str, ...]:
    """The names of :func:`explain_colors`."""
    return explain_colors(colors).names


def explain_colors(colors: Array, table: Array | None = None) -> ColorFit:
    """The nearest of ``scene_graph.COLORS`` for each colour, in CIE Lab, whatever the light.

    Light and shade scale a colour, which alone would turn orange into brown, and a coloured light
    scales its channels. The blocks of a scene are lit alike, so one shade and one light are sought
    that explain all of them best; each may differ from the shade a little, at a cost, or be of
    metal.

    Args:
        colors: sRGB in 0..1, shape (N, 3).
        table: what the picture shows before the blocks, likewise, shape (3,); None: not known, and
            no block is taken for metal.
    """
    if len(colors) == 0:
        return ColorFit((), (), np.zeros(0), np.zeros(0), np.ones(3), np.zeros((0, len(_NAMES))))
    white = _explain(colors, table, np.ones((1, 3)))
    enough = len(colors) >= _ENOUGH and white.distances.max() < _WHITE_ENOUGH
    if enough and white.margins.min() >= MIN_MARGIN:
        return white
    found = _in_any_light(colors, table, _MOST_COST)
    if _is_strange(found.light):
        found = _in_any_light(colors, table, _MOST_COST_IF_STRANGE)
    return found


def _in_any_light(colors: Array, table: Array | None, most: float) -> ColorFit:
    """The same for lights of any colour; ``most`` is what a block without a name costs [ΔE²]."""
    coarse = _explain(colors, table, _lights(_GAINS), most)
    fine = _explain(colors, table, coarse.light * _lights(_FINER_GAINS), most)
    # A light far from the best one may explain the blocks by other names.
    margins = np.minimum(fine.margins, coarse.margins)
    gaps = np.minimum(fine.gaps, coarse.gaps)
    return ColorFit(fine.names, fine.others, fine.distances, margins, fine.light, gaps)


def _is_strange(light: Array) -> bool:
    """Whether few lights have this colour, gains of red, green and blue."""
    return bool((np.abs(_WARMTH @ np.log(light[[0, 2]])) > _USUAL_LIGHT).any())


def _lights(gains: Array) -> Array:
    """Lights of all pairs of gains of red and of blue, shape (lights, 3)."""
    red, blue = (gain.ravel() for gain in np.meshgrid(gains, gains, indexing="ij"))
    return np.stack([red, np.ones_like(red), blue], axis=-1)


def _explain(
    colors: Array, table: Array | None, gains: Array, most: float = _MOST_COST
) -> ColorFit:
    """The same for lights of certain colours only, shape (lights, 3)."""
    diffuse, metal = _distances(_linear(colors), table, gains)
    costs = _of_scene(diffuse, metal, most)
    bounded = np.minimum(costs, most)  # (shades of the scene, lights, N, names)
    least_own = bounded.min(axis=3)
    tint = _GAIN_COST * (np.log(gains) ** 2).sum(axis=1)
    unusual = _SCENE_SHADE_COST * np.log(_SHADES / _USUAL_SHADE) ** 2
    total = least_own.sum(axis=2) + tint + unusual[:, None]
    shade, light = divmod(int(total.argmin()), len(gains))
    best = costs[shade, light].astype(np.float64)
    order = np.argsort(best, axis=1)[:, :2]
    of = np.arange(len(colors))
    first, second = best[of, order[:, 0]], best[of, order[:, 1]]
    # How much all are worse explained together, where one is called otherwise.
    others = (total[..., None] - least_own)[..., None]
    by_name = (others + bounded).min(axis=(0, 1))
    by_name[of, order[:, 0]] = np.inf
    risen = np.sqrt(np.maximum(by_name.min(axis=1) - total.min(), 0.0))
    is_metal = metal[light, of, order[:, 0]] <= first
    return ColorFit(
        tuple(_NAMES[index] for index in order[:, 0]),
        tuple(_NAMES[index] for index in order[:, 1]),
        np.sqrt(np.maximum(first - _METAL_COST * is_metal, 0.0)),
        np.minimum(np.sqrt(second) - np.sqrt(first), risen),
        gains[light],
        _gaps(best, (others + costs).min(axis=(0, 1))),
    )


def _of_scene(diffuse: Real, metal: Real, most: float) -> Real:
    """Costs of names by the shade of the scene, where each block may have another one at a cost.

    Args:
        diffuse, metal: see :func:`_distances`.
        most: what a block without a name costs [ΔE²].

    Returns:
        Shape (shades of the scene, lights, N, names).
    """
    # A shade that differs by so many steps costs more than no name.
    reach = int(np.sqrt(most / _OWN_SHADE_COST) / _STEP) + 2
    apart: Array = np.asarray(
        _OWN_SHADE_COST * (_STEP * np.arange(reach + 1)) ** 2, dtype=np.float64
    )
    library = written(_FILE)
    if library is None:
        return of_scene_by_numpy(diffuse, metal, apart)
    costs, steps = np.empty(diffuse.shape, np.float32), apart.astype(np.float32)
    library.of_scene(
        len(_SHADES), metal.size, reach, address(diffuse), address(metal), address(steps),
        address(costs),
    )  # fmt: skip
    return costs


def of_scene_by_numpy(diffuse: Real, metal: Real, apart: Array) -> Real:
    """As :func:`_of_scene`; ``apart`` is what a shade costs so many steps away."""
    costs, reach = np.empty(diffuse.shape, np.float32), len(apart) - 1
    for scene, cost in enumerate(costs):
        cost[:] = metal
        for own in range(max(0, scene - reach), min(len(_SHADES), scene + reach + 1)):
            np.minimum(cost, diffuse[own] + np.float32(apart[abs(own - scene)]), out=cost)
    return costs


def _gaps(best: Array, by_name: Array) -> Array:
    """By how much each name fits worse than the best one, in one light and in any, (N, names).

    Args:
        best: squared distances of the blocks from all names in the best light, (N, names).
        by_name: costs of all blocks together, where one is called so, likewise.
    """
    apart = np.sqrt(best) - np.sqrt(best.min(axis=1, keepdims=True))
    risen = np.sqrt(np.maximum(by_name - by_name.min(axis=1, keepdims=True), 0.0))
    return np.minimum(apart, risen)


def _distances(light: Array, table: Array | None, gains: Array) -> tuple[Real, Real]:
    """Squared distances of the blocks from all names, costs of sheen and metal included [ΔE²].

    Args:
        light: of the blocks, linear, shape (N, 3).
        table: see :func:`explain_colors`.
        gains: of the lights' codes, shape (lights, 3).

    Returns:
        Diffuse, (shades, lights, N, names), and metal, (lights, N, names).
    """
    lights, of_light = len(gains), gains**_GAMMA
    diffuse = np.empty((len(_SHADES), lights, len(light), len(_NAMES)), np.float32)
    metal = np.full(diffuse.shape[1:], np.inf, np.float32)
    wanted = np.log(_BRIGHTNESS / np.maximum(light @ _LUMINANCE, 1e-4))
    levels = np.abs(wanted[:, None] - np.log(_LEVELS)).argmin(axis=1)
    seen = (light * _LEVELS[levels][:, None])[:, None]
    plain, of_gains = len(_SHADES) * len(_NAMES), gains.tobytes()
    shown = [_shown(of_gains, int(level)) for level in levels]
    for index, at in enumerate(_lab(seen / of_light)):
        _put_diffuse(diffuse, index, at, *shown[index])
    if table is None:
        return diffuse, metal
    before = _linear(table)
    tint = before / of_light
    tint = tint / tint.mean(axis=1, keepdims=True)
    usual = _OF_TABLE * float(before.mean()) + _OF_ROOM
    shade_cost = _METAL_SHADE_COST * (np.log(_SHADES) - np.log(usual) / _GAMMA) ** 2
    shade_cost = (shade_cost + _METAL_COST)[:, None].astype(np.float32)
    for part in _OF_TINT:
        for index, at in enumerate(_lab(seen / (of_light * tint**part))):
            names, squares = shown[index]
            cost = _squared(at, names[:, :plain], squares[:, :plain])
            cost = cost.reshape(lights, len(_SHADES), len(_NAMES)) + shade_cost
            np.minimum(metal[:, index], cost.min(axis=1), out=metal[:, index])
    return diffuse, metal


def _put_diffuse(diffuse: Real, index: int, at: Real, shown: Real, squares: Real) -> None:
    """Fills in a block's distances from all names, with what is mirrored as costs least.

    Args:
        diffuse: see :func:`_distances`; that of the block ``index`` is written.
        at: what is seen of the block in each light, CIE Lab, shape (lights, 3).
        shown, squares: see :func:`_shown`.
    """
    library = written(_FILE)
    if library is None:
        put_diffuse_by_numpy(diffuse, index, at, shown, squares)
        return
    # |a - b|² by a product.
    product, length = shown @ (-2.0 * at)[:, :, None], (at**2).sum(axis=1)
    library.put_diffuse(
        len(at), len(_SHEEN), len(_SHADES), diffuse.shape[2], len(_NAMES), index,
        *map(address, (product, squares, length, np.array(_SHEEN_COST, np.float32), diffuse)),
    )  # fmt: skip


def put_diffuse_by_numpy(diffuse: Real, index: int, at: Real, shown: Real, squares: Real) -> None:
    """As :func:`_put_diffuse`."""
    cost = _squared(at, shown, squares)
    cost = cost.reshape(len(at), len(_SHEEN), len(_SHADES), len(_NAMES))
    sheen_cost = np.array(_SHEEN_COST, np.float32)[:, None, None]
    diffuse[:, :, index] = (cost + sheen_cost).min(axis=1).transpose(1, 0, 2)


def _squared(at: Real, shown: Real, squares: Real) -> Real:
    """Squared distances in CIE Lab of what is seen in each light from all that may be shown in it.

    Args:
        at: in CIE Lab, shape (lights, 3).
        shown, squares: see :func:`_shown`.
    """
    # |a - b|² by a product.
    product = shown @ (-2.0 * at)[:, :, None]
    return np.maximum(product[..., 0] + squares + (at**2).sum(axis=1)[:, None], np.float32(0.0))


@functools.lru_cache(maxsize=64)
def _shown(gains: bytes, level: int) -> tuple[Real, Real]:
    """CIE Lab of every colour in every shade, with what it mirrors of the light, and its square.

    As it is once the light is taken out of what a sensor that saturates saw.

    Args:
        gains: of the lights, the bytes of doubles of shape (lights, 3).
        level: which of the gains by which colours are compared.

    Returns:
        Names fastest, then shades, then sheen, shape (lights, sheens · shades · names, 3), without
        the last axis the square.
    """
    light = np.frombuffer(gains).reshape(-1, 1, 3) ** _GAMMA
    palette = _linear(np.array([COLORS[name] for name in _NAMES]))
    mirrored = palette + np.array(_SHEEN)[:, None, None, None]
    shown = (mirrored * (_SHADES**_GAMMA)[:, None, None]).reshape(1, -1, 3)
    shown = _lab(_LEVELS[level] * np.minimum(shown * light, 1.0) / light)
    return shown, (shown**2).sum(axis=-1)


def _linear(code: Array) -> Array:
    """Light of sRGB in 0..1, any shape."""
    return np.asarray(
        np.where(code <= 0.04045, code / 12.92, ((np.maximum(code, 0.0) + 0.055) / 1.055) ** 2.4)
    )


def _lab(linear: Array) -> Real:
    """CIE Lab of linear light, which may be brighter than white, shape (..., 3)."""
    xyz = ((linear @ _XYZ_FROM_RGB.T) / _WHITE_XYZ).astype(np.float32)
    root = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + np.float32(16.0 / 116.0))
    x, y, z = np.moveaxis(root, -1, 0)
    return np.stack([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)], axis=-1)
