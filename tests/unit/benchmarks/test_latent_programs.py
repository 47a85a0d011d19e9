# SPDX-License-Identifier: Apache-2.0
"""Programs on what is seen of places answer as the same programs do on the true graph."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from latent.clevr.programs import tokens_of
from latent.clevr.questions import FAMILIES, Asker, Question, draw_question
from latent.clevr.things import ATTRIBUTES, RELATIONS, Scene, random_scene, related

from perception_node.latent.programs import ProgramNetwork, SymbolicNetwork, how_many
from perception_node.latent.sight import PLACES, Seen

WORDS = (
    "",
    *(["scene", "unique", "and", "or", "count", "exist", "more", "fewer", "equal"]),
    *(f"filter {name} {word}" for name, words in ATTRIBUTES.items() for word in words),
    *(f"relate {name}" for name in RELATIONS),
    *(f"{function} {name}" for function in ("query", "same") for name in ATTRIBUTES),
)
ANSWERS = ("no", "yes", *map(str, range(7)), *(w for words in ATTRIBUTES.values() for w in words))


def network() -> ProgramNetwork:
    torch.manual_seed(0)
    return ProgramNetwork(WORDS, ANSWERS).eval()


def numbers_of(questions: Sequence[Question]) -> torch.Tensor:
    rows = [[WORDS.index(token) for token in tokens_of(item.program)] for item in questions]
    longest = max(map(len, rows))
    return torch.tensor([row + [0] * (longest - len(row)) for row in rows])


def seen_exactly(scenes: Sequence[Scene]) -> Seen:
    """Things at the first places, each of which shows what its thing is like, beyond doubt."""
    things = torch.zeros(len(scenes), PLACES)
    words = {name: torch.full((len(scenes), PLACES, len(v)), 0.1) for name, v in ATTRIBUTES.items()}
    for number, scene in enumerate(scenes):
        things[number, : len(scene)] = 1.0
        for place, thing in enumerate(scene):
            for name, values in ATTRIBUTES.items():
                words[name][number, place] = 0.0
                words[name][number, place, sorted(values).index(getattr(thing, name))] = 1.0
    beside = torch.zeros(len(scenes), len(RELATIONS), PLACES, PLACES)
    for number, scene in enumerate(scenes):
        for row, relation in enumerate(sorted(RELATIONS)):
            for anchor in range(len(scene)):
                beside[number, row, list(related(scene, relation, anchor)), anchor] = 1.0
    return Seen(things, words, beside)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.sampled_from(sorted(FAMILIES)))
def test_what_is_seen_exactly_is_answered_rightly(seed: int, family: str) -> None:
    rng = np.random.default_rng(seed)
    scene = random_scene(rng)
    drawn = (draw_question(family, scene, rng) for _ in range(20))
    questions = [item for item in drawn if item is not None]
    if not questions:
        return
    net = network()
    owners = torch.zeros(len(questions), dtype=torch.int64)
    with torch.no_grad():
        logits = net.execute(seen_exactly([scene]), numbers_of(questions), owners)
    given_answers = [ANSWERS[number] for number in logits.argmax(1)]
    assert given_answers == [item.answer for item in questions]


@pytest.mark.parametrize("family", FAMILIES)
def test_a_program_is_answered_alike_whatever_is_asked_beside_it(family: str) -> None:
    rng = np.random.default_rng(3)
    scenes = [random_scene(rng, 5) for _ in range(3)]
    asked = [
        (owner, question)
        for owner, scene in enumerate(scenes)
        for name in (family, *FAMILIES)
        for question in [draw_question(name, scene, rng)]
        if question is not None
    ]
    net, images = network(), torch.rand(3, 3, 128, 128)
    owners = torch.tensor([owner for owner, _ in asked])
    questions = numbers_of([question for _, question in asked])
    with torch.no_grad():
        together = net(images, questions, owners)
        order = torch.randperm(len(asked), generator=torch.Generator().manual_seed(1))
        again = net(images, questions[order], owners[order])
        alone = net(images[:1], questions[:1], owners[:1])
    assert torch.allclose(together[order], again, atol=1e-5)
    assert torch.allclose(together[:1], alone, atol=1e-4)


def test_answers_teach_what_places_show() -> None:
    rng = np.random.default_rng(0)
    kept = Asker().ask(random_scene(rng, 6), rng)
    assert any("hop" in item.family for item in kept)
    net = network().train()
    logits = net(torch.rand(1, 3, 128, 128), numbers_of(kept), torch.zeros(len(kept)).long())
    right = torch.tensor([ANSWERS.index(item.answer) for item in kept])
    torch.nn.functional.cross_entropy(logits, right).backward()
    still = [name for name, item in net.named_parameters() if item.grad is None]
    assert not still


def test_a_graph_is_what_is_most_likely() -> None:
    rng = np.random.default_rng(4)
    scene = random_scene(rng)
    questions = [q for name in FAMILIES if (q := draw_question(name, scene, rng)) is not None]
    certain, net = seen_exactly([scene]), network()
    unsure = Seen(
        things=0.2 + 0.6 * certain.things,
        words={name: 0.1 + 0.5 * shares for name, shares in certain.words.items()},
        beside=0.2 + 0.6 * certain.beside,
    )
    owners = torch.zeros(len(questions), dtype=torch.int64)
    with torch.no_grad():
        right = net.execute(certain, numbers_of(questions), owners)
        net.sight.register_forward_hook(lambda *_: unsure)
        read = SymbolicNetwork(net)(torch.zeros(1, 3, 128, 128), numbers_of(questions), owners)
    assert torch.allclose(read, right, atol=1e-4)


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6))
def test_numbers_are_distributed_as_by_all_cases(shares: list[float]) -> None:
    expected = np.zeros(len(shares) + 1)
    for case in product((0, 1), repeat=len(shares)):
        chances = [share if happens else 1.0 - share for share, happens in zip(shares, case)]
        expected[sum(case)] += np.prod(chances)
    numbers = how_many(torch.tensor([shares], dtype=torch.float64))
    assert np.allclose(numbers[0].numpy(), expected, atol=1e-9)
