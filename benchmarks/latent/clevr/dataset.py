# SPDX-License-Identifier: Apache-2.0
"""The data set of scenes and questions: pictures, questions with programs, and a manifest.

A folder holds, for each shard, ``images_NNNN.npz`` with images (n, 128, 128, 3) uint8 and
``questions_NNNN.json``: for each scene its things, and its questions. Shards are written whole, the
questions last; what is there is not made again. ``more_NNNN.json`` holds further questions about
the same scenes, asked in later rounds.
"""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from scene_graph import object_name
from sim_node import Block, CameraConfig, World

from ..blocks_world import MANIFEST, DataError, content_digest
from ..views import Jitter, take_picture
from .programs import Step
from .questions import Asker, Question
from .things import EDGES, Scene, Thing, random_scene

#: Looks down on the table, so that little hides another thing.
CAMERA: Final = CameraConfig(
    position_world=(1.25, 0.0, 0.75), target_world=(0.52, 0.0, 0.03), vertical_fov=0.64
)
SHARD: Final = 200


@dataclass(frozen=True)
class ClevrConfig:
    """What a data set is made of.

    Attributes:
        scenes: how many.
        first: number of the first scene; no two sets share a scene whose numbers do not overlap.
        seed: of all that is drawn.
    """

    scenes: int
    first: int = 0
    seed: int = 0


def render_clevr(folder: Path, config: ClevrConfig) -> bool:
    """Writes what is not yet there of a data set; whether it is complete, or Ctrl-C ended it.

    Raises:
        DataError: the folder holds a set of another configuration.
    """
    folder.mkdir(parents=True, exist_ok=True)
    begun, wanted = folder / "config.json", asdict(config)
    if begun.exists() and json.loads(begun.read_text()) != wanted:
        raise DataError(f"{folder} holds a data set of another configuration; name another folder")
    begun.write_text(json.dumps(wanted, indent=1) + "\n")
    asker = Asker()
    try:
        with World() as world, tqdm(total=config.scenes, unit="scene", desc=str(folder)) as shown:
            world.reset((("red_box",), (), ()), 0, settle_time=0.0)
            world.remove_block("red_box")
            for shard in range(-(-config.scenes // SHARD)):
                numbers = range(shard * SHARD, min((shard + 1) * SHARD, config.scenes))
                _shard(world, folder, shard, [config.first + n for n in numbers], config, asker)
                shown.update(len(numbers))
    except KeyboardInterrupt:
        return False
    files = sorted(folder.glob("images_*.npz"))
    manifest = {
        "config": wanted,
        "questions": sum(sum(counts.values()) for counts in asker.answers.values()),
        "answers": {name: dict(sorted(c.items())) for name, c in asker.answers.items()},
        "sha256": {path.name: content_digest(path) for path in files},
    }
    (folder / MANIFEST).write_text(json.dumps(manifest, indent=1) + "\n")
    return True


def _shard(
    world: World, folder: Path, shard: int, numbers: list[int], config: ClevrConfig, asker: Asker
) -> None:
    told = folder / f"questions_{shard:04d}.json"
    if told.exists():
        for item in json.loads(told.read_text()):
            for question in item["questions"]:
                asker.take(question_of(question))
        return
    images, entries = [], []
    for number in numbers:
        rng = np.random.default_rng([config.seed, number])
        scene = random_scene(rng)
        images.append(picture_of(world, scene, rng))
        questions = asker.ask(scene, rng)
        entries.append(
            {"things": [asdict(t) for t in scene], "questions": [asdict(q) for q in questions]}
        )
    np.savez_compressed(folder / f"images_{shard:04d}.npz", images=np.stack(images))
    partial = folder / "questions.part"
    partial.write_text(json.dumps(entries))
    partial.rename(told)


def ask_more(folder: Path, rounds: int) -> bool:
    """Asks about the scenes of a complete set again; whether done, or Ctrl-C ended it.

    Args:
        folder: of the set.
        rounds: how often each scene is asked about, the questions that it came with being one.

    Raises:
        DataError: the set was asked in another number of rounds.
    """
    config = json.loads((folder / "config.json").read_text())
    asker = Asker()
    try:
        for path in tqdm(sorted(folder.glob("questions_*.json")), desc=f"{folder}, more questions"):
            first = config["first"] + SHARD * int(path.stem.split("_")[1])
            _ask_shard_again(path, first, config["seed"], rounds, asker)
    except KeyboardInterrupt:
        return False
    return True


def _ask_shard_again(path: Path, first: int, seed: int, rounds: int, asker: Asker) -> None:
    more = _more_of(path)
    if more.exists():
        kept = json.loads(more.read_text())
        if kept["rounds"] != rounds:
            raise DataError(
                f"{more} was asked in {kept['rounds']} rounds, not {rounds}; ask as often, or "
                "delete the files more_*.json"
            )
        asker.answers = {name: Counter(counts) for name, counts in kept["answers"].items()}
        return
    asked: list[list[dict[str, Any]]] = []
    for number, entry in enumerate(json.loads(path.read_text()), first):
        scene = tuple(map(_thing_of, entry["things"]))
        known = {tuple(item["words"]) for item in entry["questions"]}
        asked.append([])
        for turn in range(1, rounds):
            for question in asker.ask(scene, np.random.default_rng([seed, number, turn])):
                if question.words not in known:
                    known.add(question.words)
                    asked[-1].append(asdict(question))
    partial = more.with_name("more.part")
    kept = {"rounds": rounds, "answers": asker.answers, "questions": asked}
    partial.write_text(json.dumps(kept))
    partial.rename(more)


def _more_of(questions: Path) -> Path:
    return questions.with_name(questions.name.replace("questions", "more"))


def picture_of(world: World, scene: Scene, rng: np.random.Generator) -> NDArray[np.uint8]:
    """A picture of a scene, shape (128, 128, 3), its camera and light a little off."""
    for number, thing in enumerate(scene):
        edge = EDGES[thing.size]
        name = object_name(thing.color, thing.shape)
        block = Block(f"{number}_{name}", thing.color, thing.shape, (edge,) * 3, 0.1, 0.9)
        world.add_block(block, np.array(thing.position_world))
        half = 0.5 * thing.yaw
        turned = (0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
        world.move_block(block.name, thing.position_world, turned)
    image = take_picture(world, Jitter(), rng, CAMERA)
    for name in world.names:
        world.remove_block(name)
    return image


@dataclass(frozen=True)
class ClevrSet:
    """A data set as it is read.

    Attributes:
        images: shape (s, 128, 128, 3).
        scenes: the true graphs; for evaluation only.
        questions: of each scene.
    """

    images: NDArray[np.uint8]
    scenes: tuple[Scene, ...]
    questions: tuple[tuple[Question, ...], ...]


def read_clevr(folder: Path) -> ClevrSet:
    """Reads a complete data set; raises DataError."""
    if not (folder / MANIFEST).exists():
        raise DataError(f"{folder} holds no complete data set; `make data-latent` writes it")
    images, entries = [], []
    for path in sorted(folder.glob("images_*.npz")):
        with np.load(path) as file:
            images.append(file["images"])
        told = path.with_name(path.name.replace("images", "questions")).with_suffix(".json")
        read = json.loads(told.read_text())
        if _more_of(told).exists():
            more = json.loads(_more_of(told).read_text())["questions"]
            for entry, items in zip(read, more):
                entry["questions"] += items
        entries += read
    return ClevrSet(
        np.concatenate(images),
        tuple(tuple(map(_thing_of, entry["things"])) for entry in entries),
        tuple(tuple(map(question_of, entry["questions"])) for entry in entries),
    )


def question_of(data: dict[str, Any]) -> Question:
    """A question from plain data."""
    return Question(data["family"], tuple(data["words"]), _step_of(data["program"]), data["answer"])


def _step_of(data: dict[str, Any]) -> Step:
    return Step(data["function"], tuple(map(_step_of, data["inputs"])), tuple(data["words"]))


def _thing_of(data: dict[str, Any]) -> Thing:
    x, y, z = data["position_world"]
    return Thing(**{**data, "position_world": (x, y, z)})
