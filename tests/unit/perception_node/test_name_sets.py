# SPDX-License-Identifier: Apache-2.0
"""Colours in doubt about few readings make a set of graphs; other doubt is refused as ever."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from seen_worlds import camera_of

from perception_node import Observation, Perception, load_weights
from perception_node.light import MIN_MARGIN, explain_colors
from perception_node.name_sets import conformal_threshold, load_name_sets, possible_colors
from scene_graph import COLORS, GraphStatus, Stacks, up_relations
from sim_node import World, parse_scene

CERTAIN = ("blue", "green", "yellow")
PLAIN: Stacks = (
    ("pink_box",),
    ("red_box", "cyan_box", "green_box", "yellow_box", "blue_box"),
    (),
)
LAYOUT: Stacks = (("blue_box", "orange_box"), ("green_box",), ("yellow_box",))


def mixed(first: str, second: str, share: float) -> np.ndarray:
    return (1.0 - share) * np.array(COLORS[first]) + share * np.array(COLORS[second])


#: As red as orange.
BETWEEN = mixed("red", "orange", 0.5)


def sets_of(*paints: np.ndarray, threshold: float = 10.0) -> tuple[tuple[str, ...], ...] | None:
    """Of these beside three blocks whose colours are plain."""
    colors = 0.85 * np.array([*(COLORS[name] for name in CERTAIN), *paints])
    return possible_colors(explain_colors(colors), colors, None, threshold)


@pytest.mark.parametrize(
    "pair", [("red", "orange"), ("orange", "red"), ("pink", "red")], ids="-".join
)
@pytest.mark.parametrize("share", [0.42, 0.5, 0.58])
def test_a_colour_between_two_may_be_either(pair: tuple[str, str], share: float) -> None:
    sets = sets_of(mixed(*pair, share))
    assert sets is not None
    assert sets[:3] == tuple((name,) for name in CERTAIN)
    assert set(pair) <= set(sets[3])


def test_nothing_that_is_not_certain_is_told_as_if_it_were() -> None:
    sets = sets_of(mixed("red", "orange", 0.4), threshold=0.0)
    assert sets is not None and len(sets[3]) == 2


@pytest.mark.parametrize(
    "paints",
    [
        [np.array([1.0, 1.0, 1.0]) * 0.35, mixed("red", "orange", 0.5), mixed("pink", "red", 0.5)],
        [np.array([0.0, 1.0, 0.0])],
    ],
    ids=["three in doubt", "far from all colours"],
)
def test_doubt_about_too_much_is_no_set(paints: list[np.ndarray]) -> None:
    assert sets_of(*paints) is None


def test_in_light_that_tells_no_colours_there_is_no_set() -> None:
    colors = np.array([COLORS[name] for name in (*CERTAIN, "red")]) * (1.4, 0.7, 0.1)
    colors = np.minimum(colors, 1.0)
    assert possible_colors(explain_colors(colors), colors, None, 10.0) is None


def test_in_coloured_light_there_is_no_set() -> None:
    colors = 0.85 * np.array([*(COLORS[name] for name in (*CERTAIN, "red", "pink")), BETWEEN])
    assert possible_colors(explain_colors(colors), colors, None, 10.0) is not None
    warm = colors * (1.15, 1.0, 0.75)
    assert possible_colors(explain_colors(warm), warm, None, 10.0) is None


Paints = dict[str, tuple[float, float, float]]


@pytest.mark.parametrize(
    ("exposure", "plain", "paints"),
    [
        (
            0.937,
            ("blue", "purple", "red", "brown"),
            {"orange": (0.966, 0.663, 0.073), "pink": (0.925, 0.358, 0.473)},
        ),
        (
            0.902,
            ("blue", "green", "yellow"),
            {"pink": (0.93, 0.378, 0.502), "orange": (0.971, 0.601, 0.064)},
        ),
        (
            1.097,
            ("blue", "cyan", "green"),
            {"purple": (0.305, 0.199, 0.748), "orange": (0.925, 0.331, 0.071)},
        ),
    ],
    ids=["orange as yellow", "orange and pink", "purple as blue"],
)
def test_paints_that_look_plain_in_a_strange_light_are_in_doubt(
    exposure: float, plain: tuple[str, ...], paints: Paints
) -> None:
    """Two of them at once are explained well by a light that is reddish, but no lamp's."""
    true = (*plain, *paints)
    colors = np.array([*(COLORS[name] for name in plain), *paints.values()])
    colors, table = 0.785 * exposure * colors, exposure * np.array([0.82, 0.78, 0.72])
    fit = explain_colors(colors, table)
    assert not fit.known.all() or (fit.margins < MIN_MARGIN).any()
    sets = possible_colors(fit, colors, table, load_name_sets().threshold)
    assert sets is not None
    assert all(name in some for name, some in zip(true, sets))


@given(st.lists(st.floats(0.0, 20.0), min_size=1, max_size=300), st.floats(0.5, 0.99))
def test_the_threshold_leaves_as_many_above_it_as_the_coverage_allows(
    scores: list[float], coverage: float
) -> None:
    threshold = conformal_threshold(scores, coverage)
    below = sum(score <= threshold for score in scores)
    if math.isinf(threshold):
        assert len(scores) < (len(scores) + 1) * coverage  # too few to say so
    else:
        assert below >= coverage * (len(scores) + 1)
        smaller = [score for score in scores if score < threshold]
        assert len(smaller) < (len(scores) + 1) * coverage


def test_a_picture_of_such_a_block_is_a_doubtful_graph_that_may_be_the_right_one() -> None:
    paint = [round(float(part), 3) for part in mixed("orange", "red", 0.45)]
    world = World(parse_scene(f"blocks: {{named: {{orange_box: {{paint: {paint}}}}}}}"))
    with world:
        world.reset(LAYOUT)
        frame, camera = world.render(), camera_of(world)
    seen = Perception(load_weights()).perceive(Observation(frame.rgb, None, frame.depth, camera))
    assert seen.status is GraphStatus.DOUBTFUL, seen.message
    assert "may be" in seen.message and "say which it is" in seen.message
    assert seen.coverage == load_name_sets().coverage > 0.0
    (doubtful,) = [item for item in seen.graph.objects if item.alternatives]
    assert "orange" in doubtful.readings
    assert seen.graph.renamed({doubtful.name: "orange_box"}).relations == up_relations(LAYOUT)


def test_plain_colours_are_no_doubt() -> None:
    sets = sets_of(np.array(COLORS["red"]))
    assert sets == tuple((name,) for name in (*CERTAIN, "red"))
    fit = explain_colors(0.85 * np.array([COLORS[name] for name in CERTAIN]))
    assert (fit.margins >= MIN_MARGIN).all()
    assert (fit.gaps.min(axis=1) == 0.0).all()


def test_a_picture_whose_channels_are_exchanged_is_no_set(world: World) -> None:
    world.reset(PLAIN)
    frame = world.render()
    exchanged = np.ascontiguousarray(frame.rgb[..., ::-1])
    seen = Perception(load_weights()).perceive(
        Observation(exchanged, None, frame.depth, camera_of(world))
    )
    assert seen.status is GraphStatus.LOW_CONFIDENCE
    assert "red and blue exchanged" in seen.message
