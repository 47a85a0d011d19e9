# SPDX-License-Identifier: Apache-2.0
"""The descent to a block's model in C: the one in numpy is the oracle."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from perception_scenes import PLACES, Solid, cast, looking_camera
from tamp_runtime import machine_code

from perception_node.blocks import descent
from perception_node.blocks.descent import Prior, Problem, descended, descended_by_numpy
from perception_node.blocks.evidence import evidence_of
from perception_node.blocks.models import BallModel, BoxModel, CylinderModel, Model
from perception_node.segment import Segments
from scene_graph import BOX, CYLINDER, SPHERE

CAMERA = looking_camera()
MODELS: dict[str, Model] = {BOX: BoxModel(), CYLINDER: CylinderModel(), SPHERE: BallModel()}

halves = st.floats(0.015, 0.03)


@st.composite
def towers(draw: st.DrawFn) -> list[Solid]:
    """Blocks of one shape, one a place, so that some see less of theirs than others."""
    solids = []
    for x, y, z in PLACES[: draw(st.integers(1, 3))]:
        half = (draw(halves), draw(halves), draw(halves))
        centre = (x, y, z + half[2])
        solids.append(Solid(BOX, centre, half, draw(st.floats(-0.78, 0.78))))
    return solids


def problem_of(solids: list[Solid], shape: str, noise: float, rng: np.random.Generator) -> Problem:
    depth, labels = cast(solids, CAMERA)
    depth = depth + rng.normal(0.0, noise, depth.shape)
    segments = Segments.from_labels(labels.astype(np.uint16))
    evidence = [evidence_of(item, segments, depth, CAMERA, noise) for item in segments]
    priors = []
    for item in evidence:
        x, y, z = item.points.mean(axis=0)
        middle = {
            BOX: [x, y, 0.1, 0.04, 0.05, z - 0.02, z + 0.02],
            CYLINDER: [x, y, 0.02, z - 0.02, z + 0.02],
            SPHERE: [x, y, z, 0.02],
        }[shape]
        start = np.array(middle) + rng.normal(0.0, 0.003, len(middle))
        priors.append(Prior.about(start, np.full(len(start), 0.02)))
    return Problem.of(MODELS[shape], priors, evidence)


@settings(max_examples=30)
@given(
    towers(), st.sampled_from(sorted(MODELS)), st.sampled_from([0.0, 0.0015]),
    st.integers(0, 1000), st.sampled_from([0, 1, 7]),
)  # fmt: skip
def test_c_descends_as_numpy_does(
    solids: list[Solid], shape: str, noise: float, seed: int, trials: int
) -> None:
    if machine_code.compiler() is None:
        pytest.skip("there is no compiler")
    problem = problem_of(solids, shape, noise, np.random.default_rng(seed))
    start = np.stack([rows.T @ values / (rows.T @ rows).diagonal()
                      for rows, values in zip(problem.rows, problem.values)])  # fmt: skip
    for each in (problem.blurred(0.004, 2.0), problem):
        fast = descended(each, start, trials, 1e-4)
        slow = descended_by_numpy(each, start, trials, 1e-4)
        assert fast.parameters == pytest.approx(slow.parameters, abs=1e-7)
        assert fast.cost == pytest.approx(slow.cost, rel=1e-6)
        assert fast.off * each.used == pytest.approx(slow.off * each.used, abs=1e-7)
        scale = np.abs(slow.information).max(axis=(1, 2), keepdims=True)
        assert fast.information / scale == pytest.approx(slow.information / scale, abs=1e-6)


@pytest.mark.parametrize("shape", sorted(MODELS))
def test_without_a_compiler_numpy_descends(monkeypatch: pytest.MonkeyPatch, shape: str) -> None:
    solid = Solid(BOX, (*PLACES[1][:2], PLACES[1][2] + 0.02), (0.02, 0.02, 0.02), 0.3)
    problem = problem_of([solid], shape, 0.0, np.random.default_rng(3))
    start: NDArray[np.float64] = np.asarray(
        np.linalg.solve(problem.rows, problem.values[..., None])[..., 0], np.float64
    )
    fast = descended(problem, start, 5, 1e-4)
    monkeypatch.setattr(descent, "written", lambda _file: None)
    assert descended(problem, start, 5, 1e-4).cost == pytest.approx(fast.cost, rel=1e-6)
