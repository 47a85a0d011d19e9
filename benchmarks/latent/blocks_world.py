# SPDX-License-Identifier: Apache-2.0
"""The blocks-world data set: pictures of every state of some blocks, and every transition.

A folder holds ``images_NNNN.npz`` with images (n, r, 128, 128, 3) uint8, r pictures of each of n
states, ``transitions.npz`` with before, move and after (t,), and ``manifest.json``, which says what
it was made with, which layout each state is, and the digest of every file. Training reads pictures
and transitions; the layouts are for evaluation only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from scene_graph import Move, Stacks, all_moves, apply_move, object_name
from sim_node import World, all_layouts

from .views import Jitter, place_blocks, take_picture

#: Of boxes, in the order in which sets of fewer blocks take them.
COLORS: Final = ("red", "green", "blue", "yellow", "purple")
STACKS: Final = 3
#: States in one file.
SHARD: Final = 120
MANIFEST: Final = "manifest.json"
TRANSITIONS: Final = "transitions.npz"
MOVES: Final[tuple[Move, ...]] = all_moves(STACKS)


class DataError(ValueError):
    """A data set that is missing, damaged, or of another kind than asked for."""


@dataclass(frozen=True)
class SetConfig:
    """What a data set is made of.

    Attributes:
        blocks: in each state.
        renders: pictures of each state.
        seed: of all that is drawn.
        jitter: by how much pictures of a state differ.
    """

    blocks: int = 5
    renders: int = 4
    seed: int = 0
    jitter: Jitter = field(default_factory=Jitter)


def all_states(blocks: int) -> list[Stacks]:
    """Every state of the first ``blocks`` boxes: 2,520 for 5, 360 for 4."""
    names = [object_name(color, "box") for color in COLORS[:blocks]]
    return list(all_layouts(names, STACKS))


def all_transitions(states: Sequence[Stacks]) -> NDArray[np.int32]:
    """Every (state, move, next state) as indices, shape (t, 3): 10,800 of 5 blocks, 1,440 of 4."""
    index = {state: number for number, state in enumerate(states)}
    found = [
        (number, action, index[apply_move(state, move)])
        for number, state in enumerate(states)
        for action, move in enumerate(MOVES)
        if state[move.source]
    ]
    return np.array(found, np.int32)


def render_set(folder: Path, config: SetConfig, limit: int | None = None) -> bool:
    """Writes what is not yet there of a data set; files appear only when they are whole.

    Args:
        limit: states, for a small set; None: all.

    Returns:
        Whether it is complete; Ctrl-C ends it between two pictures.

    Raises:
        DataError: the folder holds a set of another configuration.
    """
    states = all_states(config.blocks)
    shown = states[: limit or len(states)]
    folder.mkdir(parents=True, exist_ok=True)
    wanted = json.loads(json.dumps({**asdict(config), "states": len(shown)}))
    begun = folder / "config.json"
    if begun.exists() and json.loads(begun.read_text()) != wanted:
        raise DataError(f"{folder} holds a data set of another configuration; name another folder")
    begun.write_text(json.dumps(wanted, indent=1) + "\n")
    try:
        _render(folder, config, shown)
    except KeyboardInterrupt:
        return False
    transitions = all_transitions(states)
    kept = (transitions[:, [0, 2]] < len(shown)).all(axis=1)
    before, move, after = transitions[kept].T
    np.savez(folder / TRANSITIONS, before=before, move=move, after=after)
    files = sorted([*folder.glob("images_*.npz"), folder / TRANSITIONS])
    manifest = {
        "config": wanted,
        "layouts": shown,
        "moves": [str(item) for item in MOVES],
        "transitions": int(kept.sum()),
        "sha256": {path.name: content_digest(path) for path in files},
    }
    (folder / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n")
    return True


def _render(folder: Path, config: SetConfig, states: Sequence[Stacks]) -> None:
    with World() as world, tqdm(total=len(states), unit="state", desc=str(folder)) as progress:
        world.reset(states[0], config.seed, settle_time=0.0)
        for number, start in enumerate(range(0, len(states), SHARD)):
            path = folder / f"images_{number:04d}.npz"
            part = states[start : start + SHARD]
            if not path.exists():
                pictures = [
                    pictures_of(world, state, config, start + offset)
                    for offset, state in enumerate(part)
                ]
                partial = folder / "part.npz"
                np.savez_compressed(partial, images=np.stack(pictures))
                partial.rename(path)
            progress.update(len(part))


def pictures_of(world: World, state: Stacks, config: SetConfig, number: int) -> NDArray[np.uint8]:
    """Pictures of one state, shape (r, 128, 128, 3); each has its own draws."""
    taken = []
    for render in range(config.renders):
        rng = np.random.default_rng([config.seed, config.blocks, number, render])
        place_blocks(world, state, config.jitter, rng)
        taken.append(take_picture(world, config.jitter, rng))
    return np.stack(taken)


def content_digest(path: Path) -> str:
    """SHA-256 of the arrays in a file: of what it holds, not of how that is packed."""
    digest = hashlib.sha256()
    with np.load(path) as file:
        for name in sorted(file.files):
            array = np.ascontiguousarray(file[name])
            digest.update(f"{name} {array.dtype} {array.shape}".encode())
            digest.update(array.tobytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class BlocksWorld:
    """A data set as it is read.

    Attributes:
        images: shape (s, r, 128, 128, 3).
        before, move, after: transitions, shape (t,); moves are indices into MOVES.
        layouts: of the states; for evaluation only.
    """

    images: NDArray[np.uint8]
    before: NDArray[np.int64]
    move: NDArray[np.int64]
    after: NDArray[np.int64]
    layouts: tuple[Stacks, ...]


def read_set(folder: Path) -> BlocksWorld:
    """Reads a complete data set.

    Raises:
        DataError: it is not there, or not complete.
    """
    manifest = read_manifest(folder)
    images = np.concatenate(list(_arrays(sorted(folder.glob("images_*.npz")))))
    with np.load(folder / TRANSITIONS) as file:
        before, move, after = (file[name].astype(np.int64) for name in ("before", "move", "after"))
    layouts = tuple(tuple(map(tuple, layout)) for layout in manifest["layouts"])
    return BlocksWorld(images, before, move, after, layouts)


def read_manifest(folder: Path) -> dict[str, Any]:
    """What a data set says of itself; raises DataError."""
    path = folder / MANIFEST
    if not path.exists():
        raise DataError(f"{folder} holds no complete data set; `make data-latent` writes it")
    manifest: dict[str, Any] = json.loads(path.read_text())
    return manifest


def _arrays(paths: Sequence[Path]) -> Iterator[NDArray[np.uint8]]:
    for path in paths:
        with np.load(path) as file:
            yield file["images"]
