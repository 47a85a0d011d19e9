# SPDX-License-Identifier: Apache-2.0
"""How codes, predictions and plans are judged: by hand on small cases."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from latent.clevr.dataset import CAMERA, ClevrSet
from latent.clevr.things import ATTRIBUTES, Thing
from latent.linear_reader import places_of, words_named_right
from latent.planning import carried_out, majority, pairs, plan_all
from latent.prediction import CopyState, NearestTransition, accuracy
from latent.qa_training import gain_rows
from latent.stability import noisy, uniqueness

from perception_node.latent.state_encoder import EncoderConfig, StateEncoder
from planner_node.action_models import ObservedModel
from planner_node.search.on_models import breadth_first_on
from scene_graph import SPHERE, Move, Stacks


def code(*values: int) -> np.ndarray:
    return np.array([[value] for value in values], np.uint8)


def test_accuracies_count_bits_changed_bits_and_whole_codes() -> None:
    found = accuracy(code(0b0001, 0b0011), code(0b0000, 0b0000), code(0b0001, 0b0001))
    assert (found.bits, found.changed, found.whole, found.n) == (15 / 16, 1.0, 0.5, 2)
    copied = CopyState()(code(0b0000), np.array([0]))
    assert accuracy(copied, code(0), code(0b0011)).changed == 0.0


def test_the_nearest_transition_is_that_of_the_same_action() -> None:
    seen = NearestTransition(code(0b0000, 0b1111, 0b1110), np.array([0, 0, 1]), code(1, 2, 3))
    assert seen(code(0b0111, 0b0001, 0b1111), np.array([0, 0, 1]))[:, 0].tolist() == [2, 1, 3]


def test_codes_that_two_states_share_are_counted_for_both() -> None:
    codes = np.array([[[1], [1]], [[2], [1]], [[4], [4]]], np.uint8)
    found = uniqueness(codes)
    assert found.distinct == 1.0 - 2 / 3
    assert found.nearest == 2
    assert found.same == 2 / 3


def test_the_most_frequent_code_of_a_state_is_its_own() -> None:
    assert majority(np.array([[[1], [2], [2]], [[3], [4], [5]]], np.uint8)).tolist() == [[2], [3]]


def test_noise_is_the_same_each_time_and_as_strong_as_asked() -> None:
    image = np.full((1, 128, 128, 3), 128, np.uint8)
    once, again = noisy(image, 0.05, 1), noisy(image, 0.05, 1)
    assert np.array_equal(once, again)
    assert abs(float((once / 255.0).std()) - 0.05) < 0.002
    assert not np.array_equal(once, noisy(image, 0.05, 2))


def test_plans_are_judged_by_the_rules_and_not_by_the_model() -> None:
    """Of two models that both lead to the goal's code one is right about the world."""
    layouts: list[Stacks] = [(("red_box",), ()), ((), ("red_box",))]
    codes, tasks = code(7, 9), np.array([[0, 1]])
    for move, valid in ((Move(0, 1), 1), (Move(1, 0), 0)):
        model = ObservedModel([(b"\x07", move, b"\x09")])
        plans = plan_all(model, breadth_first_on, tasks, codes, codes, layouts, {b"\x07"})
        assert (plans.n, plans.valid, plans.states, plans.hallucinated) == (1, valid, 2, 1)
        assert len(plans.failures) == 1 - valid


def test_moves_are_carried_out_until_one_is_impossible() -> None:
    start: Stacks = (("red_box", "blue_box"), ())
    assert carried_out(start, [Move(0, 1)]) == (("red_box",), ("blue_box",))
    assert carried_out(start, [Move(1, 0)]) is None


def test_pairs_are_of_different_states() -> None:
    drawn = pairs(300, 4, 1000)
    assert (drawn[:, 0] != drawn[:, 1]).all() and set(drawn.ravel().tolist()) == {0, 1, 2, 3}


def test_questions_about_one_scene_count_as_failing_together() -> None:
    right = {
        "kl": [np.ones(4, np.bool_)],
        "reconstruction": [np.array([False, False, True, True])],
    }
    owners = np.array([0, 0, 1, 1])
    (row,) = gain_rows(right, 64, owners)
    half = 1.96 * np.hypot(1.0, 1.0) / 4
    assert row.spread == pytest.approx((0.5 - half, 0.5 + half))
    assert row.value == pytest.approx(0.5 - half) and row.holds is False
    assert [row.holds for row in gain_rows(right, 8, owners)] == [None]
    assert gain_rows({"kl": right["kl"]}, 64, owners) == []


def test_of_several_seeds_each_question_counts_once() -> None:
    owners = np.array([0, 0, 1, 1])
    one, other = np.ones(4, np.bool_), np.array([True, True, False, False])
    right = {"kl": [one, one], "reconstruction": [other, ~other]}
    (row,) = gain_rows(right, 64, owners)
    # In the mean of the seeds each question gains a half: no scene is above another one.
    assert row.spread == pytest.approx((0.5, 0.5)) and row.n == 4 and row.holds
    assert row.note is not None and row.note.endswith("2 seeds: +0.5000, +0.5000")


def painted(scenes: int, seed: int) -> ClevrSet:
    """Grey pictures in which the place of the one thing has its colour, and nothing more of it."""
    rng, values = np.random.default_rng(seed), (30, 220)
    images = np.full((scenes, 128, 128, 3), 128, np.uint8)
    things = []
    for image in images:
        number = int(rng.integers(6))
        size, shape = (str(rng.choice(ATTRIBUTES[name])) for name in ("size", "shape"))
        position = (float(rng.uniform(0.4, 0.6)), float(rng.uniform(-0.1, 0.1)), 0.03)
        things.append((Thing(size, ATTRIBUTES["color"][number], shape, position, 0.0),))
        column, row = 4 * places_of(things[-1])[0]
        image[row : row + 4, column : column + 4] = [values[number + 1 >> i & 1] for i in range(3)]
    return ClevrSet(images, tuple(things), ((),) * scenes)


def test_a_linear_reader_names_what_codes_show_and_nothing_else() -> None:
    torch.manual_seed(0)
    right, scenes = words_named_right(
        StateEncoder(EncoderConfig(channels=64, width=8)), painted(120, 0), painted(100, 1)
    )
    assert scenes.tolist() == list(range(100))
    size, color, shape = right.mean(0)
    assert color > 0.95 and size < 0.7 and shape < 0.6


def test_things_are_read_where_the_camera_sees_them() -> None:
    def at(*position: float) -> tuple[Thing, ...]:
        return (Thing("small", "red", SPHERE, (position[0], position[1], position[2]), 0.0),)

    (middle,) = places_of(at(*CAMERA.target_world))
    assert set(middle) <= {15, 16}
    # The camera looks along -x: what is farther along y is farther to the right, above is above.
    (right,), (above,) = places_of(at(0.52, 0.1, 0.03)), places_of(at(0.52, 0.0, 0.03 + 0.1))
    assert right[0] > middle[0] and right[1] == middle[1]
    assert above[1] < middle[1] and above[0] == middle[0]
