# SPDX-License-Identifier: Apache-2.0
"""The probability that a graph is right is fitted rightly, and is that of what is perceived."""

import numpy as np
import pytest
from perception.score import calibration_error
from seen_worlds import TOWERS, perceive

from perception_node.probability import EVIDENCE, fit, load_parameters, probability
from sim_node import World


def draws(seed: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Evidence, what is right, and how likely that was."""
    rng = np.random.default_rng(seed)
    seen = np.column_stack([np.ones(count), rng.normal(size=(count, 3))])
    likely = 1.0 / (1.0 + np.exp(-seen @ np.array([1.0, 2.0, -1.0, 0.0])))
    return seen, rng.random(count) < likely, likely


def test_what_is_drawn_from_a_model_is_fitted_by_it_and_calibrated_on_other_draws() -> None:
    weights = fit(*draws(1, 20_000)[:2])
    assert np.abs(weights - (1.0, 2.0, -1.0, 0.0)).max() < 0.1
    seen, right, likely = draws(2, 20_000)
    stated = np.array([probability(tuple(row), weights) for row in seen])
    assert np.abs(stated - likely).mean() < 0.02
    assert calibration_error(stated, right) < 0.02
    assert calibration_error(np.full(len(right), 0.95), right) > 0.2


def test_evidence_that_leaves_no_doubt_ends() -> None:
    seen = np.column_stack([np.ones(100), np.arange(100) < 50])
    weights = fit(seen, np.arange(100) < 50)
    assert np.isfinite(weights).all()
    assert probability((1.0, 1.0), weights) > 0.95 > 0.05 > probability((1.0, 0.0), weights)


def test_the_parameters_are_those_of_the_evidence(world: World) -> None:
    weights = load_parameters()
    world.reset(TOWERS)
    perceived = perceive(world)
    assert len(perceived.evidence) == len(EVIDENCE) == len(weights)
    assert perceived.probability == pytest.approx(probability(perceived.evidence, weights))


def test_a_clear_scene_is_likelier_right_than_one_in_doubt(world: World) -> None:
    weights = load_parameters()
    world.reset(TOWERS)
    perceived = perceive(world)
    assert perceived.probability > 0.95
    doubt = list(perceived.evidence)
    doubt[EVIDENCE.index("worst distance of a colour")] = 3.0
    doubt[EVIDENCE.index("low confidence")] = 1.0
    assert probability(tuple(doubt), weights) < perceived.probability
