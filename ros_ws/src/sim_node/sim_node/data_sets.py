# SPDX-License-Identifier: Apache-2.0
"""``ros2 run sim_node render_dataset``: pictures of states, for training and evaluation.

Writes npz shards: rgb (n, h, w, 3) uint8, depth (n, h, w) float32 [m], labels (n, h, w) uint16,
and, for evaluation only, layouts (n,) and names (n,) as JSON: the state, and each label's name.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import Final

import numpy as np
from tqdm import tqdm

from scene_graph import BASIC_COLORS, BOX, Stacks, object_name

from .layouts import all_layouts, random_layout
from .world import World

SHARD_SIZE: Final = 120


def render_shard(world: World, states: Iterable[tuple[int, Stacks]], path: Path) -> None:
    """Renders (seed, layout) pairs into one file, which appears only when it is whole."""
    frames, layouts, names = [], [], []
    for seed, layout in states:
        world.reset(layout, seed, settle_time=0.1)
        frames.append(world.render())
        layouts.append(json.dumps(layout))
        names.append(json.dumps({world.label(name): name for name in world.names}))
    part = path.with_suffix(".part.npz")
    np.savez_compressed(
        part,
        rgb=np.stack([frame.rgb for frame in frames]),
        depth=np.stack([frame.depth for frame in frames]),
        labels=np.stack([frame.labels for frame in frames]),
        layouts=np.array(layouts),
        names=np.array(names),
    )
    part.rename(path)


def states_of_colors(blocks: int) -> Iterable[tuple[int, Stacks]]:
    """All states of the first ``blocks`` colours; the colours take turns from state to state.

    Every state of the blocks' order appears once; which colour is which block rotates through all
    known colours, so that a network trained on them has seen each.
    """
    colors = BASIC_COLORS
    places = [str(index) for index in range(blocks)]
    for seed, layout in enumerate(all_layouts(places)):
        turn = {
            place: object_name(colors[(index + seed) % len(colors)], BOX)
            for index, place in enumerate(places)
        }
        yield seed, tuple(tuple(turn[place] for place in stack) for stack in layout)


def main() -> int:
    """Renders all states, or random ones; files that are there are left alone."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("data/states_5"), help="folder to write")
    parser.add_argument("--blocks", type=int, default=5, help="blocks in each state (1 to 7)")
    parser.add_argument(
        "--random", type=int, metavar="N", help="N random states instead of all of them"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the first random state")
    options = parser.parse_args()
    if options.random is None:
        states = list(states_of_colors(options.blocks))
    else:
        seeds = range(options.seed, options.seed + options.random)
        states = [(seed, random_layout(seed, options.blocks)) for seed in seeds]
    options.out.mkdir(parents=True, exist_ok=True)
    remaining = iter(states)
    try:
        with World() as world, tqdm(total=len(states), unit="state") as progress:
            for number in range(-(-len(states) // SHARD_SIZE)):
                shard = list(islice(remaining, SHARD_SIZE))
                path = options.out / f"shard_{number:04d}.npz"
                if not path.exists():
                    render_shard(world, shard, path)
                progress.update(len(shard))
    except KeyboardInterrupt:
        print("stopped; the same command goes on where this one ended")
        return 130
    return 0
