# SPDX-License-Identifier: Apache-2.0
"""One graph of what several cameras see of one moment.

Each view is understood by itself. Blocks of two views that are measured at one spot are one block;
its measurements, normal distributions, are joined before anything is concluded from them:
C = (Σ Cᵢ⁻¹)⁻¹, x = C Σ Cᵢ⁻¹ xᵢ. What one camera does not see another one may: a point is free if
any camera sees through it, and a block that one camera sees, where another one sees through, is a
contradiction, which is refused.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from scene_graph import BOX, GraphStatus, SceneGraph, SceneObject

from .blocks import Blocks, BlockSurface, centres
from .blocks.pose import pose_blocks
from .camera import PinholeCamera
from .errors import ContradictionError, PerceptionError, with_topics_of
from .graph import build_graph
from .hiding import find_hidden
from .names import Names, unique_names
from .observation import Observation
from .pipeline import Perceived, Perception
from .places import FromAnywhere
from .places.hidden import cells_over, free_share, seen_through
from .places.occlusion import Occlusion
from .probability import evidence, load_parameters, probability
from .segment import Segment, Segments
from .strays import with_strays
from .verdict import judge, judge_empty, with_grain
from .view import View
from .visual_module.coordinates import Coordinates

Array = NDArray[np.float64]

#: Axes or upper ends of one block as two cameras measure them are no further apart [m], and up to
#: twice as far where that is within two standard deviations.
SAME_BLOCK: Final = 0.02
#: Where they are further apart than this and so many standard deviations, a calibration is wrong.
AGREES: Final = 0.006
DEVIATIONS: Final = 4.0
#: A block of which a camera sees through so large a share is not there.
SEEN_THROUGH: Final = 0.3
#: What lies further than this from every block is none of them [m].
APART: Final = 0.04
_GLIMPSES: Final = (
    "of no block enough is seen to say what it is; take away what is before them, or look from "
    "another side"
)
#: Two cameras may see all blocks so far from one another, as calibrations are not exact [m].
OFFSET: Final = 0.004
#: x, y and high among the parameters of a surface.
_SPOT: Final = [0, 1, 6]
#: x, y, low and high among the parameters of a surface.
_WHERE: Final = [0, 1, 5, 6]


@dataclass(frozen=True)
class _Sighting:
    """One block in one view.

    Attributes:
        camera: its name.
        index: of the block in the view.
        surface: as measured.
        item: of the view's own graph.
        covered: whether something before it covers a part.
    """

    camera: str
    index: int
    surface: BlockSurface
    item: SceneObject
    covered: bool

    @property
    def spot(self) -> Array:
        """x, y of the axis, z of the upper end: also known of a covered one, shape (3,) [m]."""
        return np.array([*self.surface.position, self.surface.high])

    @property
    def doubt(self) -> Array:
        """Standard deviations of the spot, shape (3,) [m]."""
        return np.asarray(np.sqrt(np.diag(self.surface.covariance)[_SPOT]))


_Block = tuple[_Sighting, ...]


class JoinedViews:
    """Perception through several cameras. Keeps nothing but where the first one was last.

    Args:
        perception: as for one camera.
        first: name of the camera for which things are left, right and in front.
    """

    def __init__(self, perception: Perception, first: str) -> None:
        self._one, self._name = perception, first
        self._each = Perception(
            perception.locator, perception.config, perception.segmenter, FromAnywhere
        )
        self._weights = load_parameters()
        self._camera: PinholeCamera | None = None

    def configured(self, perception: Perception) -> JoinedViews:
        """The same with another configuration."""
        other = JoinedViews(perception, self._name)
        other._camera = self._camera
        return other

    def perceive(self, observations: Mapping[str, Observation]) -> Perceived:
        """Interprets what cameras deliver of one moment.

        What is wrong with some of the pictures is told, and the others are used.

        Args:
            observations: by the names of the cameras, at least one.
        """
        every = {name: self._understood(name, item) for name, item in observations.items()}
        for item in every.values():
            useless = item.view is None and item.status is not GraphStatus.BAD_IMAGE
            if useless or (item.view is not None and item.view.fallen):
                return replace(item, view=None)
        views = {name: item for name, item in every.items() if item.view is not None}
        bad = "; ".join(item.message for name, item in every.items() if name not in views)
        if not views:
            return self._one.rejected(GraphStatus.BAD_IMAGE, bad)
        if self._name in views or self._camera is None:
            nearest = views.get(self._name, next(iter(views.values())))
            assert nearest.view is not None
            self._camera = nearest.view.observation.camera
        try:
            joined = self._join(views)
        except ContradictionError as error:
            joined = self._one.rejected(GraphStatus.LOW_CONFIDENCE, str(error))
        except PerceptionError as error:
            joined = self._one.rejected(GraphStatus.BAD_IMAGE, str(error))
        return replace(joined, message="; ".join(filter(None, (joined.message, bad))))

    def _understood(self, camera: str, observation: Observation) -> Perceived:
        perceived = self._each.perceive(observation)
        told = with_topics_of(camera, perceived.message)
        if told == perceived.message and camera != self._name:
            told = f"{camera}: {told}"
        return replace(perceived, message=told)

    def _join(self, perceived: Mapping[str, Perceived]) -> Perceived:
        """Raises PerceptionError."""
        config = self._one.config
        views = {name: item.view for name, item in perceived.items() if item.view is not None}
        occlusion = _least_hidden([view.occlusion for view in views.values()])
        found: list[_Block] = []
        for name, item in perceived.items():
            found = _matched(found, _sightings(name, item))
        glimpses = [one for view in views.values() for one in view.seen.glimpses]
        if not found and glimpses:
            return self._one.rejected(GraphStatus.OCCLUDED, _GLIMPSES)
        if not found:
            return self._one.rejected(*judge_empty(occlusion, config))
        _check_offset(found)
        main = next(iter(views))
        observation = replace(views[main].observation, camera=self._camera)
        segments = views[main].seen.segments
        coordinates = _coordinates(found)
        surfaces = tuple(map(_fused, found))
        places = self._one.places.seen_by(self._camera)
        standing = places.stand(observation, segments, coordinates, centres(surfaces))
        measured = pose_blocks(
            *(surfaces, standing.stacks, standing.table_heights),
            [index for index, block in enumerate(found) if all(one.covered for one in block)],
            config.smallest_block,
        )
        blocks = Blocks(tuple(item.shape for item in measured), measured)
        known_names = {n: view.names for n, view in views.items() if view.names is not None}
        names = _names(found, blocks.shapes, standing.stacks, known_names)
        _check_seen_through(found, names.names, blocks, views)
        size = config.column_half_width, config.column_height
        cells = seen_through(
            [
                cells_over(view.observation, view.seen.segments, standing.places, *size)
                for view in views.values()
            ]
        )
        hidden = find_hidden(cells, standing, blocks, glimpses, config)
        graph = build_graph(
            *(observation, _labelled(segments, found, main), occlusion, coordinates),
            *(standing, blocks, names, hidden),
        )
        verdict = judge(graph, occlusion, standing, blocks, names, config, hidden)
        noise = max(view.observation.noise for view in views.values())
        known = evidence(graph, verdict.status, blocks, names, occlusion, noise)
        doubtful = verdict.status is GraphStatus.DOUBTFUL
        return Perceived(
            with_strays(graph, _strays(perceived.values(), graph)),
            *with_grain(verdict, noise),
            segments,
            probability(known, self._weights),
            known,
            min(item.coverage for item in perceived.values() if item.coverage) if doubtful else 0.0,
        )


def _least_hidden(every: Sequence[Occlusion]) -> Occlusion:
    """For each place as it is in the view where the least of it is hidden."""
    known = [item for item in every if item.shares]
    if not known:
        return Occlusion()
    return Occlusion(
        None,
        tuple(map(min, zip(*(item.shares for item in known)))),
        tuple(map(max, zip(*(item.seen_to for item in known)))),
    )


def _sightings(camera: str, perceived: Perceived) -> list[_Sighting]:
    view, graph = perceived.view, perceived.graph
    assert view is not None
    if view.names is None:
        return []
    return [
        _Sighting(camera, index, surface, graph.object(name), index in view.seen.partly)
        for index, (surface, name) in enumerate(zip(view.seen.surfaces, view.names.names))
    ]


def _matched(found: Sequence[_Block], seen: Sequence[_Sighting]) -> list[_Block]:
    """Blocks that are known, with one sighting more each where there is one, and new ones.

    One sighting belongs to one block at most: those whose distances are least in sum.
    """
    if not found or not seen:
        return [*found, *((one,) for one in seen)]
    spots = np.array([np.mean([one.spot for one in block], axis=0) for block in found])
    doubts = np.array([np.max([one.doubt for one in block], axis=0) for block in found])
    apart = np.abs(spots[:, None] - np.array([one.spot for one in seen]))
    doubt = np.hypot(doubts[:, None], np.array([one.doubt for one in seen]))
    apart = np.maximum(apart - np.minimum(2.0 * doubt, SAME_BLOCK), 0.0)
    far = np.maximum(np.hypot(apart[..., 0], apart[..., 1]), apart[..., 2])
    rows, columns = linear_sum_assignment(np.minimum(far, SAME_BLOCK))
    of = {int(i): seen[int(j)] for i, j in zip(rows, columns) if far[i, j] < SAME_BLOCK}
    more = [(one,) for one in seen if all(one is not other for other in of.values())]
    return [*(block + ((of[i],) if i in of else ()) for i, block in enumerate(found)), *more]


def _fused(block: _Block) -> BlockSurface:
    """The measurement of all views that see a block uncovered; of all where there is none.

    Where they differ by more than they say, its covariance is larger by as much: χ² / degrees.

    Raises:
        ContradictionError: if they differ by more than they can.
    """
    used = [one for one in block if not one.covered] or list(block)
    for one in used[1:]:
        _check_agreement(used[0], one)
    best = min(used, key=lambda one: float(np.trace(one.surface.covariance[:2, :2])))
    alike = [one for one in used if one.surface.shape == best.surface.shape]
    parts = [_turned_like(one.surface, best.surface) for one in alike]
    values = np.array([part for part, _ in parts])
    information = np.array([np.linalg.pinv(part, hermitian=True) for _, part in parts])
    covariance = np.linalg.pinv(information.sum(axis=0), hermitian=True)
    mean = covariance @ np.einsum("vij,vj->i", information, values)
    if len(alike) > 1:
        off = values - mean
        degrees = len(mean) * (len(alike) - 1)
        covariance *= max(1.0, np.einsum("vi,vij,vj->", off, information, off) / degrees)
    quarters = round(mean[2] / (0.5 * np.pi))
    mean, covariance = _turned(mean, covariance, -quarters)
    x, y, yaw, along, across, low, high = (float(value) for value in mean)
    others = {one.surface.shape for one in used} - {best.surface.shape}
    return replace(
        best.surface,
        position=(x, y),
        yaw=yaw,
        widths=(along, across),
        low=low,
        high=high,
        covariance=covariance,
        tilt=max(one.surface.tilt for one in used),
        rival=min(others) if others else best.surface.rival,
        seen_low=min(one.surface.seen_low for one in block),
        sharp=all(one.surface.sharp for one in used),
    )


def _check_offset(found: Sequence[_Block]) -> None:
    """Raises ContradictionError if one camera sees all blocks beside where another one does.

    The offset is that of least Σ (dᵢ - t)ᵀ Wᵢ (dᵢ - t), Wᵢ⁻¹ the covariance of a difference dᵢ, so
    that blocks of which each camera sees a part tell together what none of them does.
    """
    pairs: dict[tuple[str, str], list[tuple[_Sighting, _Sighting]]] = {}
    for block in found:
        for one, other in combinations(block, 2):
            pairs.setdefault((one.camera, other.camera), []).append((one, other))
    for (camera, another), both in pairs.items():
        apart = np.array([other.spot - one.spot for one, other in both])
        rows = np.ix_(_SPOT, _SPOT)
        weights = np.array(
            [
                np.linalg.inv(one.surface.covariance[rows] + other.surface.covariance[rows])
                for one, other in both
            ]
        )
        total = weights.sum(axis=0)
        offset = np.linalg.solve(total, np.einsum("bij,bj->i", weights, apart))
        far = float(np.linalg.norm(offset))
        if far > OFFSET and offset @ total @ offset > DEVIATIONS**2:
            names = ", ".join(sorted(one.item.name for one, _ in both))
            raise ContradictionError(
                f"{names} for {another} are {1000 * far:.0f} mm from where {camera} sees them; "
                f"check {camera}/extrinsics and {another}/extrinsics"
            )


def _turned_like(surface: BlockSurface, like: BlockSurface) -> tuple[Array, Array]:
    """Parameters and covariance, those of a box by the quarter turn that is nearest to another."""
    values = np.array([*surface.position, surface.yaw, *surface.widths, surface.low, surface.high])
    quarters = round((like.yaw - surface.yaw) / (0.5 * np.pi)) if surface.shape == BOX else 0
    return _turned(values, surface.covariance, quarters)


def _turned(values: Array, covariance: Array, quarters: int) -> tuple[Array, Array]:
    """The same box, so many quarter turns further."""
    order = [0, 1, 2, 4, 3, 5, 6] if quarters % 2 else [*range(7)]
    values = values + 0.5 * np.pi * quarters * (np.arange(7) == 2)
    return values[order], covariance[np.ix_(order, order)]


def _check_agreement(one: _Sighting, other: _Sighting) -> None:
    """Raises ContradictionError if two cameras see one block at two spots."""
    (here, doubt), (there, other_doubt) = (
        _turned_like(item.surface, one.surface) for item in (one, other)
    )
    apart = np.abs(here - there)[_WHERE]
    most = AGREES + DEVIATIONS * np.sqrt(np.diag(doubt + other_doubt))[_WHERE]
    if (apart > most).any():
        raise ContradictionError(
            f"{other.item.name} is {1000 * apart.max():.0f} mm from where {one.camera} sees it for "
            f"{other.camera}; check {one.camera}/extrinsics and {other.camera}/extrinsics, and "
            "that nothing moved between the pictures"
        )


def _coordinates(found: Sequence[_Block]) -> Coordinates:
    """What the visual module says of the blocks where it is surest of each."""
    best = [max(block, key=lambda one: one.item.confidence).item for block in found]
    phi = np.array([item.coordinates for item in best])
    return Coordinates(phi, phi, phi, np.array([item.confidence for item in best]))


def _labelled(segments: Segments, found: Sequence[_Block], camera: str) -> Segments:
    """The blocks that are found, by their labels in a camera's picture; 0 where it sees none."""
    nothing = np.zeros(segments.label_image.shape, bool)
    blocks = []
    for block in found:
        labels = [one.item.label for one in block if one.camera == camera]
        blocks.append(Segment(labels[0] if labels else 0, nothing, nothing))
    return replace(segments, blocks=tuple(blocks))


def _names(
    found: Sequence[_Block],
    shapes: Sequence[str],
    stacks: Sequence[Sequence[int]],
    views: Mapping[str, Names],
) -> Names:
    """What the blocks are called: by the colours that all views say they may have.

    Views that are in doubt, and do not say between what, are asked last.

    Raises:
        ContradictionError: if there is no such colour.
    """
    readings, doubts = [], []
    for block in found:
        used = [one for one in block if not one.covered] or list(block)
        sure = [one for one in used if not views[one.camera].doubt or one.item.alternatives]
        sure += [one for one in used if one not in sure and views[one.camera].alternatives]
        doubts += [views[one.camera].doubt for one in used if not sure]
        colors = [one.item.readings or (one.item.color,) for one in sure or used]
        common = [color for color in colors[0] if all(color in some for some in colors)]
        if not common:
            one, other = next(
                (used[0], one)
                for one, some in zip(sure or used, colors)
                if colors[0][0] not in some
            )
            raise ContradictionError(
                f"{one.item.name} for {one.camera} is {other.item.name} for {other.camera}; "
                "look from where the light is better, and check their extrinsics"
            )
        readings.append(common)
    names = unique_names([some[0] for some in readings], shapes, stacks)
    several = [f"the colour of {name} may be {' or '.join(some)}"
               for name, some in zip(names, readings) if len(some) > 1]  # fmt: skip
    unsure = doubts[0] if doubts else ""
    choice = f"{' and '.join(several)}; give it more light, or say which it is" if several else ""
    return Names(
        tuple(some[0] for some in readings),
        names,
        unsure or choice,
        max(item.distance for item in views.values()),
        min(item.margin for item in views.values()),
        tuple(tuple(some[1:]) for some in readings) if several and not unsure else (),
    )


def _check_seen_through(
    found: Sequence[_Block], names: Sequence[str], blocks: Blocks, views: Mapping[str, View]
) -> None:
    """Raises ContradictionError if a camera sees through a block that another one sees."""
    for block, name, measured in zip(found, names, blocks.measured):
        seen_by = [one.camera for one in block]
        for camera, view in views.items():
            if camera in seen_by:
                continue
            if free_share(view.observation, measured.pose) > SEEN_THROUGH:
                raise ContradictionError(
                    f"{camera} sees nothing where {name} stands for {seen_by[0]}; check "
                    f"{camera}/extrinsics and {seen_by[0]}/extrinsics, and that nothing moved "
                    "between the pictures"
                )


def _strays(every: Iterable[Perceived], graph: SceneGraph) -> tuple[SceneObject, ...]:
    """What a view sees lie before the places and is no block of the graph."""
    blocks = np.array([item.position_world[:2] for item in graph.objects])
    return tuple(
        item
        for perceived in every
        if perceived.view is not None and perceived.view.names is not None
        for item in perceived.graph.objects
        if item.name not in perceived.view.names.names
        and np.hypot(*(blocks - item.position_world[:2]).T).min() > APART
    )
