# SPDX-License-Identifier: Apache-2.0
"""``make data-masks``: pictures to train the network that finds blocks in colour alone.

Random scenes (seeds no benchmark has) as :class:`FrontView` shows them, in npz shards: rgb (n, h,
w, 3) uint8; labels (n, h, w) uint8 of the blocks; before (n, h, w) bool, what hides the places and
is no block; and of the view feet, aside (n, w) float32 and steepness (n,) float32. Stopped, the
same command goes on.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, Final

import numpy as np
from masks.scenes import TrainingScene, draw_scene
from perception.views import view_of
from tqdm import tqdm

from perception_node import PerceptionConfig, PinholeCamera, RowOfPlaces, Volume
from perception_node.places.occlusion import Columns
from perception_node.segment.front_view import FrontView

#: Size of what is kept of a view [px].
HEIGHT: Final = 208
WIDTH: Final = 272
#: States of each scene, and scenes of each shard.
STATES: Final = 4
SCENES: Final = 40


def main() -> int:
    """Exit code 0 when done, 130 when stopped by Ctrl-C."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("data/masks"), help="folder to write")
    parser.add_argument("--shards", type=int, default=16, help="of 160 pictures each")
    parser.add_argument("--first", type=int, default=0, help="number of the first shard")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    numbers = range(options.first, options.first + options.shards)
    try:
        for number in tqdm(numbers, unit="shard"):
            path = options.out / f"shard_{number:04d}.npz"
            if path.exists():
                continue
            pictures: list[dict[str, Any]] = []
            for scene in range(SCENES * number, SCENES * (number + 1)):
                pictures += _pictures(draw_scene(scene, STATES))
            part = path.with_suffix(".part.npz")
            columns: dict[str, Any] = {
                key: np.stack([item[key] for item in pictures]) for key in pictures[0]
            }
            np.savez_compressed(part, **columns)
            part.rename(path)
    except KeyboardInterrupt:
        print("stopped; the same command goes on where this one ended")
        return 130
    return 0


def _pictures(drawn: TrainingScene) -> list[dict[str, Any]]:
    """All states of a scene, each as a part of its front view."""
    found = []
    rng = np.random.default_rng(drawn.seed)
    with drawn.world() as world:
        config = PerceptionConfig(stack_positions=world.config.stack_positions)
        columns = Columns(
            RowOfPlaces(config.stack_positions), config.column_half_width, config.column_height
        )
        feet = np.array(config.stack_positions)
        volume = Volume.over(feet, config.column_height)
        for layout in drawn.layouts:
            world.reset(layout, int(rng.integers(2**31)), settle_time=0.05)
            frame = world.render()
            camera = view_of(world.config.camera, frame).camera
            points = _points(camera, frame.depth)
            hidden = columns.hidden_by(points, camera) & (frame.labels == 0)
            view = FrontView.of(camera, volume)
            top, left = (
                int(rng.integers(0, max(1, have - want + 1)))
                for have, want in zip(view.shape, (HEIGHT, WIDTH))
            )
            box = np.s_[top : top + HEIGHT, left : left + WIDTH]
            found.append(
                {
                    "rgb": _padded(view.taken(frame.rgb)[box]),
                    "labels": _padded(view.taken(frame.labels.astype(np.uint8), True)[box]),
                    "before": _padded(view.taken(hidden.astype(np.uint8), True)[box]) > 0,
                    "feet": _padded_row(view.feet[box[1]] - top),
                    "aside": _padded_row(view.aside[box[1]]),
                    "steepness": np.float32(view.steepness),
                }
            )
    return found


def _points(camera: PinholeCamera, depth: np.ndarray) -> np.ndarray:
    """Where pixels are in world, NaN without depth, shape (height, width, 3) [m]."""
    known = np.where(depth > 0.0, depth, np.nan).astype(np.float32)
    return camera.points_world(known, (slice(0, depth.shape[0]), slice(0, depth.shape[1])))


def _padded(picture: np.ndarray) -> np.ndarray:
    more = [(0, HEIGHT - picture.shape[0]), (0, WIDTH - picture.shape[1])]
    return np.pad(picture, more + [(0, 0)] * (picture.ndim - 2))


def _padded_row(row: np.ndarray) -> np.ndarray:
    return np.pad(row, (0, WIDTH - len(row)), mode="edge")


if __name__ == "__main__":
    raise SystemExit(main())
