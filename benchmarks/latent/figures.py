# SPDX-License-Identifier: Apache-2.0
"""Figures 4.4 to 4.9 on our data: points of curves, and pictures for the results page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from results_file import Row

from perception_node.latent.state_encoder import StateEncoder

from .stability import ALPHAS, noisy

Images = NDArray[np.uint8]

#: Of the pictures of the results page, relative to it.
FOLDER: Final = Path(__file__).parents[2] / "docs" / "results"


def noise_curves(rows: Sequence[Row]) -> dict[str, Any]:
    """Figure 4.6: codes changed by noise."""
    lines: dict[str, list[list[float]]] = {}
    for row in rows:
        if row.set.startswith("noise α = "):
            alpha = float(row.set.removeprefix("noise α = "))
            lines.setdefault(row.metric, []).append([alpha, row.value])
    return {
        "title": "Codes of noisy images (Figure 4.6)",
        "x": "noise magnitude α",
        "y": "share of places changed",
        "log": "xy",
        "lines": lines,
    }


def training_curves(logs: Mapping[str, Path], quantity: str, title: str) -> dict[str, Any]:
    """One quantity of training logs over steps, by label."""
    lines = {}
    for label, path in logs.items():
        points = []
        for line in path.read_text().splitlines() if path.exists() else []:
            step, *rest = line.split()
            values = dict(zip(rest[::2], map(float, rest[1::2])))
            if quantity in values:
                points.append([int(step), values[quantity]])
        if points:
            lines[label] = points
    return {"title": title, "x": "step", "y": quantity, "log": "y", "lines": lines}


def noise_picture(encoder: StateEncoder, image: Images, seed: int) -> Images:
    """Figure 4.7: an image (128, 128, 3) under growing noise, above what its code shows."""
    given = np.concatenate([noisy(image[None], alpha, seed) for alpha in ALPHAS])
    shown = encoder.decode(encoder.encode(given, snapped=False))
    snapped = encoder.decode(encoder.encode(given))
    return _grid([given, shown, snapped])


def plan_picture(encoder: StateEncoder, plans: Sequence[Sequence[bytes]], longest: int) -> Images:
    """Figures 4.1 and 4.8: what the codes of plans show, a plan a row."""
    rows = []
    for plan in plans:
        codes = np.stack([np.frombuffer(state, np.uint8) for state in plan[:longest]])
        shown = encoder.decode(codes)
        empty = np.full((longest - len(shown), *shown.shape[1:]), 255, np.uint8)
        rows.append(np.concatenate([shown, empty]))
    return _grid(rows)


def saved(picture: Images, name: str, text: str, folder: Path = FOLDER) -> dict[str, str]:
    """Writes a picture; how the results page is told of it."""
    folder.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(folder / f"{name}.png", optimize=True)
    return {"file": f"{folder.name}/{name}.png", "text": text}


def _grid(rows: Sequence[Images]) -> Images:
    """Rows of equally many pictures, with a line of white between them."""
    padded = [np.pad(row, ((0, 0), (1, 1), (1, 1), (0, 0)), constant_values=255) for row in rows]
    return np.concatenate([np.concatenate(list(row), axis=1) for row in padded])
