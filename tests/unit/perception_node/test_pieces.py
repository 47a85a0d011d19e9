# SPDX-License-Identifier: Apache-2.0
"""What C does with pixels is what numpy does with them."""

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from perception_scenes import PLACES, looking_camera

from perception_node import alignment, depth_gaps, light
from perception_node.blocks import evidence
from perception_node.quantiles import quantile_of_codes, quantiles
from perception_node.segment import Volume, facets, leaks, pieces, region
from perception_node.segment.facets import Facets, Look
from perception_node.segment.pieces import Heights
from perception_node.visual_module import near_content

seeds = st.integers(0, 10_000)
sides = st.integers(3, 30)


class Picture:
    """A picture of few colours and depths, some of which are missing."""

    def __init__(self, seed: int, height: int, width: int) -> None:
        self.rng = np.random.default_rng(seed)
        shape = (height, width)
        scale = (-(-height // 4), -(-width // 4))
        coarse = self.rng.integers(0, 256, (*scale, 3)).repeat(4, axis=0).repeat(4, axis=1)
        grain = self.rng.integers(0, 9, (height, width, 3))
        self.rgb = np.clip(coarse[:height, :width] + grain, 0, 255).astype(np.uint8)
        depth = self.rng.uniform(0.8, 1.0, scale).repeat(4, axis=0).repeat(4, axis=1)
        self.depth = (depth[:height, :width] + self.rng.normal(0, 0.003, shape)).astype(np.float32)
        self.depth[self.rng.random(shape) < 0.2] = np.nan
        self.points = self.rng.normal(0.0, 0.02, (*shape, 3)).astype(np.float32)
        self.points[..., 2] += self.depth
        self.mask = self.rng.random(shape) < 0.8
        self.links = [
            self.rng.random((height - 1, width)) < 0.8,
            self.rng.random((height, width - 1)) < 0.8,
        ]
        ids = self.rng.integers(0, 6, scale).repeat(4, axis=0).repeat(4, axis=1)
        self.ids = np.ascontiguousarray(ids[:height, :width]).astype(np.int32)
        self.look = Look.of(self.rgb, 1.0)


pictures = st.builds(Picture, seeds, sides, sides)


def labelled(picture: Picture, links: bool, bounded: bool) -> Callable[[Any], Any]:
    labels = np.where(picture.mask, 0, picture.ids).astype(np.uint16)
    ends = [np.sort(picture.rng.uniform(0.7, 1.1, 6)) for _ in range(2)]
    heights = Heights(picture.depth, np.minimum(*ends), np.maximum(*ends)) if bounded else None

    def by(spread: Any) -> Any:
        own = labels.copy()
        spread(
            own, picture.rng.random(own.shape) < 2.0, 3, picture.links if links else None, heights
        )
        return own

    return by


def same(fast: Any, slow: Any, tolerance: float = 0.0) -> None:
    if isinstance(fast, tuple | list):
        assert len(fast) == len(slow)
        for one, other in zip(fast, slow):
            same(one, other, tolerance)
    else:
        np.testing.assert_allclose(fast, slow, rtol=0.0, atol=tolerance)


def by_numpy(call: Callable[[], Any], *modules: ModuleType) -> Any:
    """What a call gives where these modules have no C."""
    with pytest.MonkeyPatch.context() as patch:
        for module in modules:
            patch.setattr(module, "written", lambda _file: None)
        return call()


@given(pictures)
def test_pieces_and_their_borders(picture: Picture) -> None:
    fast = pieces.connected(picture.mask, picture.links)
    same(fast, pieces.connected_by_opencv(picture.mask, picture.links))
    count, ids = fast
    same(pieces.borders(count, ids, picture.ids), pieces.borders_by_numpy(99, ids, picture.ids))


@given(pictures, st.booleans(), st.booleans())
def test_labels_that_spread(picture: Picture, links: bool, bounded: bool) -> None:
    by = labelled(picture, links, bounded)
    same(by(pieces.spread), by(pieces.spread_by_numpy))


@given(pictures)
def test_ends_of_values(picture: Picture) -> None:
    values = picture.points.reshape(-1, 3)
    args = (picture.ids.ravel(), values, 7)
    same(pieces.ends_by_number(*args), pieces.ends_by_numpy(*args))


@given(pictures)
def test_links_of_facets(picture: Picture) -> None:
    same(
        facets.on_one_facet(picture.look, picture.depth),
        facets.links_by_numpy(picture.look, picture.depth),
    )
    args = (picture.points, picture.depth)
    same(facets.on_one_body(*args), facets.bodies_by_numpy(*args))


@given(pictures, st.integers(1, 9))
def test_what_is_amid_facets(picture: Picture, side: int) -> None:
    same(
        facets.uniform(picture.ids, side),
        by_numpy(lambda: facets.uniform(picture.ids, side), facets),
    )


@given(pictures, st.integers(1, 2))
def test_facets_that_leak(picture: Picture, reach: int) -> None:
    made = facets.find_facets(picture.mask, picture.links)

    def call() -> tuple[Any, ...]:
        found = leaks.without_leaks(made, picture.points[..., 2], reach)
        return found.ids, found.borders, *made.links()

    same(call(), by_numpy(call, facets, leaks, pieces))


@given(pictures)
def test_what_facets_look_like_and_how_many_pixels_they_have(picture: Picture) -> None:
    def call() -> tuple[Any, ...]:
        every = set(picture.ids.ravel().tolist())
        means = [facets.mean_look(picture.look, picture.ids, facet) for facet in every]
        return *means, facets.counts(picture.ids, picture.mask, 6)

    same(call(), by_numpy(call, facets))


@given(st.integers(1, 7), seeds, st.booleans())
def test_what_explains_colours(count: int, seed: int, on_table: bool) -> None:
    rng = np.random.default_rng(seed)
    colors, table = rng.random((count, 3)), rng.random(3) if on_table else None

    def call() -> tuple[Any, ...]:
        fit = light.explain_colors(colors, table)
        return fit.distances, fit.margins, fit.light, fit.gaps

    same(call(), by_numpy(call, light))


@given(st.integers(1, 3), st.integers(0, 24), seeds)
def test_content_with_what_is_around_it(count: int, side: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    images = np.zeros((count, 3, 32, 32), np.float32)
    for image in images:
        top, left = rng.integers(0, 33 - side, 2)
        image[:, top : top + side, left : left + side] = rng.random((3, side, side)) > 0.5
    patch = rng.random((count, 4, 4, 3)).astype(np.float32)
    empty, first = rng.random((20, 20, 3)).astype(np.float32), rng.integers(0, 12, (count, 2))

    def call() -> tuple[Any, ...]:
        around = near_content._surrounded(patch, empty, first, 8, np.full((count, 2), side % 5))
        return *near_content._content(images), around

    same(call(), by_numpy(call, near_content))


@given(pictures, st.integers(0, 100))
def test_quantiles_of_codes_are_those_of_numpy(picture: Picture, share: int) -> None:
    codes = picture.rgb[..., 0]
    assert quantile_of_codes(codes, share / 100) == np.percentile(codes, share)


@given(pictures, st.integers(0, 8))
def test_sums_over_facets(picture: Picture, few: int) -> None:
    made = Facets(picture.ids, 6, np.zeros((0, 3), np.int64))
    args = (made, picture.look, np.nan_to_num(picture.points), picture.mask, few)
    same(tuple(facets.sums(*args)), tuple(facets.sums_by_numpy(*args)), 1e-9)


@given(pictures, st.floats(1.0, 30.0))
def test_the_look_of_colours(picture: Picture, noise: float) -> None:
    look = Look.of(picture.rgb, noise)
    slow = by_numpy(lambda: Look.of(picture.rgb, noise), facets)
    same(look.chroma, slow.chroma, 1e-6)
    same(look.light, slow.light, 2e-6)


@given(pictures, st.integers(1, 4))
def test_edges_that_are_aligned(picture: Picture, reach: int) -> None:
    rgb, depth = picture.rgb, picture.depth
    same(depth_gaps.fill(depth, rgb, reach), depth_gaps.fill_by_numpy(depth, rgb, reach))
    calls = [
        lambda: alignment.sharpened(rgb, reach, 1.0),
        lambda: alignment.without_edges(depth, reach),
        lambda: alignment._moved_to_colour(depth, rgb, reach),
    ]
    fast = [call() for call in calls]
    same(fast, by_numpy(lambda: [call() for call in calls], alignment, depth_gaps))


@given(pictures)
def test_points_of_pixels(picture: Picture) -> None:
    height, width = picture.depth.shape
    camera, volume = looking_camera(), Volume.over(np.array(PLACES), 0.3)
    args = (camera, picture.depth, np.s_[40 : 40 + height, 100 : 100 + width], volume)
    (points, inside), slow = region._points(*args), region.points_by_numpy(*args)
    same(points, slow[0], 1e-6)
    # Where rounding decides nothing.
    clear = np.abs(points[..., None] - np.stack([volume.low, volume.high], -1)).min((2, 3)) > 1e-5
    same(inside[clear], slow[1][clear])


@given(pictures, st.floats(0.0, 0.01))
def test_ends_of_blocks(picture: Picture, noise: float) -> None:
    mask = np.zeros(picture.mask.shape, bool)
    mask[1:-1, 1:-1] = picture.ids[1:-1, 1:-1] > 2
    args = (mask, ~picture.mask, picture.depth.astype(np.float64), noise)
    same(evidence._ends(*args), evidence.ends_by_numpy(*args))


@given(st.integers(1, 600), st.floats(0.0, 1.0), seeds)
def test_quantiles_are_those_of_numpy(count: int, share: float, seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=(count, 2))
    expected = np.quantile(values, [share, 0.5], axis=0)
    np.testing.assert_allclose(quantiles(values, share, 0.5), expected, rtol=0.0, atol=1e-12)
