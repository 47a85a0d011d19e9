# SPDX-License-Identifier: Apache-2.0
"""How likely a whole graph is right: logistic regression on what is known of how it was made.

P(right) = 1 / (1 + exp(-w·x)), x of :func:`evidence`, w fitted by ``benchmarks/fit_probability.py``
to pictures of all kinds. The verdict decides whether a graph is planned on; this says how often
graphs like it are right, accepted or not.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from scene_graph import GraphStatus, SceneGraph

from .blocks import Blocks
from .light import MAX_DISTANCE, MIN_MARGIN
from .names import Names
from .places.occlusion import Occlusion
from .verdict import GRAIN

Array = NDArray[np.float64]

PARAMETERS: Final = Path(__file__).parent / "weights" / "graph_probability.json"
#: What each number of the evidence is, in order.
EVIDENCE: Final = (
    "bias",
    "low confidence",
    "occluded",
    "unstable",
    "not measured",
    "least IoU",
    "mean IoU",
    "deviation of the worst centre",
    "a shape in doubt",
    "worst distance of a colour",
    "worst margin of a colour",
    "hidden share",
    "noise of colours",
    "blocks",
)
#: Deviation of a centre that counts as one [m].
_DEVIATION: Final = 0.002


def evidence(
    graph: SceneGraph,
    status: GraphStatus,
    blocks: Blocks,
    names: Names,
    occlusion: Occlusion,
    noise: float,
) -> tuple[float, ...]:
    """Numbers of about the size of one, in the order of :data:`EVIDENCE`.

    Args:
        graph: of at least one block.
        noise: of the picture's channels [0..255].
    """
    iou = [item.confidence for item in graph.objects if item.label] or [0.0]
    worst = max((max(block.deviation[:2]) for block in blocks.measured), default=0.0)
    values = (
        1.0,
        float(status in (GraphStatus.LOW_CONFIDENCE, GraphStatus.DOUBTFUL)),
        float(status is GraphStatus.OCCLUDED),
        float(status is GraphStatus.UNSTABLE),
        float(not blocks.measured),
        min(iou),
        float(np.mean(iou)),
        min(worst / _DEVIATION, 3.0),
        float(any(block.rival for block in blocks.measured)),
        min(names.distance / MAX_DISTANCE, 3.0),
        min(names.margin / MIN_MARGIN, 3.0),
        min(10.0 * occlusion.greatest, 3.0),
        min(noise / GRAIN, 3.0),
        len(graph.objects) / 6.0,
    )
    return tuple(float(value) for value in values)


def probability(seen: tuple[float, ...], weights: Array) -> float:
    """That a graph with such evidence is right, 0..1."""
    return float(1.0 / (1.0 + np.exp(-np.clip(weights @ np.array(seen), -30.0, 30.0))))


def load_parameters(path: Path = PARAMETERS) -> Array:
    """The weights of :data:`EVIDENCE`, shape (n,).

    Raises:
        ValueError: if the file has others.
    """
    content = json.loads(path.read_text())["weights"]
    if tuple(content) != EVIDENCE:
        raise ValueError(
            f"{path} is of other evidence; fit it anew by benchmarks/fit_probability.py"
        )
    return np.array(list(content.values()))


def fit(seen: Array, right: NDArray[np.bool_], ridge: float = 0.03) -> Array:
    """The weights of greatest likelihood, the bias's aside drawn to 0, shape (n,).

    Args:
        seen: evidence of N graphs, shape (N, n).
        right: shape (N,).
        ridge: strength with which they are drawn to 0.
    """
    weights = np.zeros(seen.shape[1])
    penalty = ridge * np.eye(len(weights))
    penalty[0, 0] = 1e-6
    for _ in range(60):  # Newton
        p = 1.0 / (1.0 + np.exp(-np.clip(seen @ weights, -30.0, 30.0)))
        gradient = seen.T @ (right - p) - penalty @ weights
        hessian = (seen * np.maximum(p * (1.0 - p), 1e-9)[:, None]).T @ seen + penalty
        step = np.linalg.solve(hessian, gradient)
        weights = weights + step * min(1.0, 4.0 / max(1e-9, float(np.abs(step).max())))
        if np.abs(step).max() < 1e-8:
            break
    return np.asarray(weights)
