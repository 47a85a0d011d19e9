# SPDX-License-Identifier: Apache-2.0
"""Data of Chapter 4: all states and transitions, always the same, and questions that are some."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from latent.blocks_world import (
    MOVES,
    DataError,
    SetConfig,
    all_states,
    all_transitions,
    read_set,
    render_set,
)
from latent.clevr.dataset import ask_more, question_of
from latent.clevr.programs import IllPosedError, Step, answer_of, execute
from latent.clevr.questions import FAMILIES, Asker, draw_question
from latent.clevr.things import ATTRIBUTES, RELATIONS, Thing, random_scene, related

from scene_graph import apply_move


@pytest.mark.parametrize(("blocks", "states", "count"), [(4, 360, 1440), (5, 2520, 10800)])
def test_every_state_and_transition_is_there_once(blocks: int, states: int, count: int) -> None:
    layouts = all_states(blocks)
    transitions = all_transitions(layouts)
    assert len(set(layouts)) == states
    assert len({tuple(row) for row in transitions.tolist()}) == count
    for before, move, after in transitions[:: count // 40].tolist():
        assert apply_move(layouts[before], MOVES[move]) == layouts[after]


def test_a_set_is_the_same_whenever_it_is_made(tmp_path: Path) -> None:
    config = SetConfig(blocks=3, renders=2, seed=7)
    for name in ("one", "other"):
        assert render_set(tmp_path / name, config, limit=5)
    one, other = (
        json.loads((tmp_path / name / "manifest.json").read_text()) for name in ("one", "other")
    )
    assert one == other and len(one["sha256"]) == 2
    read = read_set(tmp_path / "one")
    assert read.images.shape == (5, 2, 128, 128, 3)
    assert (read.images[:, 0] != read.images[:, 1]).any(axis=(1, 2, 3)).all()
    with pytest.raises(DataError, match="another configuration"):
        render_set(tmp_path / "one", SetConfig(blocks=3, renders=2, seed=8), limit=5)


def test_a_set_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="data-latent"):
        read_set(tmp_path)


def test_relations_are_those_of_positions() -> None:
    for seed in range(30):
        scene = random_scene(np.random.default_rng(seed))
        numbers = range(len(scene))
        found = {
            name: {(b, a) for a in numbers for b in related(scene, name, a)} for name in RELATIONS
        }
        for name, inverse in (("left", "right"), ("front", "behind"), ("above", "below")):
            assert found[name] == {(b, a) for a, b in found[inverse]}
        for b, a in found["left"]:
            assert scene[b].position_world[1] < scene[a].position_world[1]
        for b, a in found["front"]:
            assert scene[b].position_world[0] > scene[a].position_world[0]
        for b, a in found["above"]:
            assert scene[b].position_world[:2] == scene[a].position_world[:2]


def test_programs_answer_what_counting_by_hand_does() -> None:
    def thing(color: str, shape: str, y: float) -> Thing:
        return Thing("small", color, shape, (0.5, y, 0.02), 0.0)

    scene = (thing("red", "box", -0.1), thing("red", "sphere", 0.0), thing("blue", "box", 0.1))
    all_things = Step("scene")
    red = Step("filter", (all_things,), ("red",))
    box = Step("filter", (all_things,), ("box",))
    blue = Step("unique", (Step("filter", (all_things,), ("blue",)),))
    left = Step("relate", (blue,), ("left",))
    assert execute(Step("count", (red,)), scene) == 2
    assert execute(Step("count", (Step("and", (red, box)),)), scene) == 1
    assert execute(Step("count", (Step("or", (red, box)),)), scene) == 3
    assert execute(Step("count", (left,)), scene) == 2
    assert execute(Step("exist", (Step("filter", (left,), ("blue",)),)), scene) is False
    assert execute(Step("query", (blue,), ("shape",)), scene) == "box"
    assert execute(Step("equal", (Step("count", (red,)), Step("count", (box,)))), scene) is True
    with pytest.raises(IllPosedError, match="2 such things"):
        execute(Step("unique", (red,)), scene)


def test_answers_are_balanced_and_every_family_is_asked() -> None:
    asker = Asker()
    for number in range(150):
        rng = np.random.default_rng([1, number])
        asker.ask(random_scene(rng), rng)
    for family in ("existence", "attribute comparison", "integer comparison"):
        yes, no = asker.answers[family]["yes"], asker.answers[family]["no"]
        assert min(yes, no) > 0.7 * max(yes, no)
    assert all(sum(counts.values()) > 0 for counts in asker.answers.values())


def test_scenes_are_asked_about_again_alike_whether_it_was_stopped_or_not(tmp_path: Path) -> None:
    scenes = [random_scene(np.random.default_rng(number)) for number in range(4)]
    for name in ("whole", "resumed"):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "config.json").write_text('{"scenes": 400, "first": 0, "seed": 5}')
        for shard in range(2):
            kept = [
                {"things": [asdict(thing) for thing in scene], "questions": []}
                for scene in scenes[2 * shard : 2 * shard + 2]
            ]
            (folder / f"questions_{shard:04d}.json").write_text(json.dumps(kept))
        assert ask_more(folder, rounds=3)
    (tmp_path / "resumed" / "more_0001.json").unlink()
    assert ask_more(tmp_path / "resumed", rounds=3)
    for shard in range(2):
        one, other = (
            json.loads((tmp_path / name / f"more_{shard:04d}.json").read_text())
            for name in ("whole", "resumed")
        )
        assert one == other
        for scene, items in zip(scenes[2 * shard :], one["questions"]):
            asked = [question_of(item) for item in items]
            assert len({item.words for item in asked}) == len(asked) > len(FAMILIES)
            assert all(answer_of(execute(item.program, scene)) == item.answer for item in asked)
    with pytest.raises(DataError, match="asked in 3 rounds, not 2"):
        ask_more(tmp_path / "whole", rounds=2)


def test_a_question_about_an_attribute_does_not_tell_it() -> None:
    for seed in range(200):
        rng = np.random.default_rng(seed)
        question = draw_question("attribute", random_scene(rng), rng)
        if question is not None:
            assert not set(ATTRIBUTES[question.words[1]]) & set(question.words)


@pytest.mark.parametrize("family", FAMILIES)
def test_what_is_drawn_is_answered_by_its_program(family: str) -> None:
    answers = set()
    for seed in range(300):
        rng = np.random.default_rng(seed)
        scene = random_scene(rng)
        question = draw_question(family, scene, rng)
        if question is not None:
            assert question.family == family and len(question.words) > 2
            answers.add(question.answer)
    assert len(answers) > 1
