# SPDX-License-Identifier: Apache-2.0
"""What is measured of one seed's action models, as rows of the result file."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from results_file import Row, wilson_interval

from perception_node.latent.state_encoder import Images, StateEncoder
from planner_node.action_models import ObservedModel, StacksModel
from planner_node.action_models.learnt import LearntModel, Snap, no_snap
from planner_node.action_models.training import BITS, THESIS
from planner_node.action_models.weights import load_action_model
from planner_node.search.code_distance import CodeDistanceAStar
from planner_node.search.on_models import (
    ModelSearch,
    NoModelPlanError,
    both_ends_on,
    breadth_first_on,
)
from scene_graph import Stacks

from .bench import TEST_SEED, Bench
from .blocks_world import MOVES, BlocksWorld
from .planning import MAX_STATES, Plans, majority, pairs, plan_all
from .prediction import Accuracy, CopyState, NearestTransition, Predict, accuracy
from .trainings import split

#: Thesis: accuracy of D and of π (4.2.2).
THESIS_D: Final = 0.94
THESIS_POLICY: Final = 0.65
_FOUR: Final = "4 blocks, unseen"
_FIVE: Final = "5 blocks, held out"


def searches(bench: Bench) -> dict[str, ModelSearch[bytes]]:
    """By name; A* knows how many bits a move changes at most, as far as it was observed."""
    world, codes = bench.train, bench.codes["train_5"][:, 0]
    seen = split(world).seen
    changed = np.unpackbits(codes[world.before[seen]] ^ codes[world.after[seen]], axis=1).sum(1)
    return {
        "from both ends": both_ends_on,
        "A*": CodeDistanceAStar(int(changed.max())),
        "breadth first": breadth_first_on,
    }


def observed_rows(bench: Bench, details: dict[str, Any]) -> list[Row]:
    """Planning with M1, by three searches, from and to pictures that nothing was made of."""
    rows = []
    for label, world, known, shown, pictures in _domains(bench):
        central = majority(known)
        model = ObservedModel(
            (central[before].tobytes(), MOVES[move], central[after].tobytes())
            for before, move, after in zip(world.before, world.move, world.after)
        )
        real = {code.tobytes() for code in central}
        tasks = pairs(bench.tasks, len(central), TEST_SEED)
        lengths = shortest_lengths(world.layouts, tasks)
        title = f"M1, {label.partition(',')[0]}, unseen pictures"
        starts, goals = (
            _as_observed(model, real, bench.encoder, shown[:, side], pictures[side])
            for side in (0, 1)
        )
        taken = np.stack([starts[tasks[:, 0]], goals[tasks[:, 1]]])
        given = np.stack([shown[tasks[:, 0], 0], shown[tasks[:, 1], 1]])
        other = (taken != given).any(axis=2)
        rows.append(
            Row(title, "codes of no state, taken for the nearest one", float(other.mean()), "",
                other.size, note=f"{other.sum()} of the pictures planned between")
        )  # fmt: skip
        for name, search in searches(bench).items():
            plans = plan_all(model, search, tasks, starts, goals, world.layouts, real, lengths)
            rows += _plan_rows(title, name, plans, ">= 1")
            details[f"{title}, {name}"] = plans.failures[:10]
    return rows


def prediction_rows(bench: Bench) -> list[Row]:
    """D and π on what they have not seen, beside two baselines."""
    rows = []
    held = split(bench.train).held_out
    known = bench.codes["train_5"]
    seen = split(bench.train).seen
    nearest = NearestTransition(
        known[bench.train.before[seen], 0],
        bench.train.move[seen],
        known[bench.train.after[seen], 0],
    )
    for label, world, codes, taken in (
        (_FOUR, bench.four, bench.codes["test_4"], np.arange(len(bench.four.before))),
        (_FIVE, bench.train, known, held),
    ):
        before = codes[world.before[taken], 0]
        action, after = world.move[taken], codes[world.after[taken], 1]
        for objective in (BITS, THESIS):
            model = learnt_model(bench, objective, no_snap)
            if model is None:
                continue
            if objective == BITS:
                rows.append(_discriminator_row(label, model, world, codes))
            methods: dict[str, Predict] = {_name(objective): model.raw}
            if objective == BITS:
                methods[_name(objective) + ", snapped"] = _snapped(model, bench)
            for name, predict in methods.items():
                found = accuracy(predict(before, action), before, after)
                rows += _accuracy_rows(label, name, found, bounded=name.endswith("snapped"))
        for name, baseline in (("copy-state", CopyState()), ("nearest transition", nearest)):
            rows += _accuracy_rows(
                label, name, accuracy(baseline(before, action), before, after), bounded=False
            )
    return rows


def learnt_rows(bench: Bench, details: dict[str, Any], names: Sequence[str]) -> list[Row]:
    """Planning with M2 alone."""
    rows, found_by = [], searches(bench)
    for label, world, known, shown, _ in _domains(bench):
        central = majority(known)
        real = {code.tobytes() for code in central}
        tasks = pairs(bench.tasks, len(central), TEST_SEED)
        lengths = shortest_lengths(world.layouts, tasks)
        for verify in (True, False):
            for name in names if verify else names[:1]:
                snap = bench.encoder.snap if verify else no_snap
                model = learnt_model(bench, BITS, snap, verify)
                if model is None:
                    continue
                plans = plan_all(
                    model, found_by[name], tasks, shown[:, 0], shown[:, -1], world.layouts, real,
                    lengths,
                )  # fmt: skip
                kind = "M2" if verify else "M2 neither snapped nor verified"
                rows += _plan_rows(f"{kind}, {label}", name, plans, ">= 0.9" if verify else None)
                details[f"{kind}, {label}, {name}"] = plans.failures[:10]
    return rows


def cold_rows(bench: Bench, moves: int = 6, count: int = 10) -> list[Row]:
    """Time of a plan of some moves by a model that remembers nothing of plans before."""
    model = learnt_model(bench, BITS, bench.encoder.snap)
    if model is None:
        return []
    codes, layouts = bench.codes["test_5"][:, 0], bench.train.layouts
    tasks = pairs(40 * count, len(codes), TEST_SEED)
    lengths = shortest_lengths(layouts, tasks)
    seconds = []
    for start, goal in [task for task, length in lengths.items() if length == moves][:count]:
        model.forget()
        begun = time.perf_counter()
        both_ends_on(model, codes[start].tobytes(), codes[goal].tobytes(), MAX_STATES)
        seconds.append(time.perf_counter() - begun)
    return [
        Row("M2, 5 blocks", f"a plan of {moves} moves, nothing remembered, median",
            float(np.median(seconds)), "s", len(seconds), (min(seconds), max(seconds)),
            required="<= 2")
    ]  # fmt: skip


def sample_plans(bench: Bench, count: int) -> list[tuple[bytes, ...]]:
    """Codes along the longest plans of M2 among the first tasks on 5 blocks."""
    model = learnt_model(bench, BITS, bench.encoder.snap)
    if model is None:
        return []
    codes = bench.codes["test_5"][:, 0]
    found = []
    for start, goal in pairs(4 * count, len(codes), TEST_SEED).tolist():
        try:
            plan = both_ends_on(model, codes[start].tobytes(), codes[goal].tobytes(), MAX_STATES)
        except NoModelPlanError:
            continue
        found.append(plan.states)
    return sorted(found, key=len, reverse=True)[:count]


def learnt_model(
    bench: Bench, objective: str, snap: Snap, verify: bool = True
) -> LearntModel | None:
    """The trained model; None where it was not trained."""
    path = bench.folder / objective / "action_model.safetensors"
    if not path.exists():
        return None
    return LearntModel(*load_action_model(path), MOVES, snap, verify)


def shortest_lengths(
    layouts: Sequence[Stacks], tasks: NDArray[np.int64]
) -> dict[tuple[int, int], int]:
    """Least numbers of moves by the rules on stacks."""
    rules = StacksModel()
    return {
        (start, goal): len(both_ends_on(rules, layouts[start], layouts[goal]).moves)
        for start, goal in tasks.tolist()
    }


def _domains(
    bench: Bench,
) -> list[tuple[str, BlocksWorld, NDArray[np.uint8], NDArray[np.uint8], Sequence[Images]]]:
    """Label, transitions, codes that M1 is made of, those to plan between, and their pictures."""
    four, five = bench.four.images, bench.five.images[:, 0]
    codes = bench.codes["test_4"]
    between = np.repeat(bench.codes["test_5"][:, :1], 2, axis=1)
    return [
        (_FOUR, bench.four, codes[:, 1:2], codes[:, ::2], (four[:, 0], four[:, 2])),
        (_FIVE, bench.train, bench.codes["train_5"], between, (five, five)),
    ]


def _as_observed(
    model: ObservedModel[bytes],
    real: Collection[bytes],
    encoder: StateEncoder,
    codes: NDArray[np.uint8],
    pictures: Images,
) -> NDArray[np.uint8]:
    """Codes (s, b) of pictures, those of no state as the one that M1 takes them for.

    That is told by all bits: one part that was snapped to a wrong pattern is farther off so.
    """
    lost = [number for number, code in enumerate(codes) if code.tobytes() not in real]
    read = codes.copy()
    for number, code in zip(lost, encoder.encode(pictures[lost], snapped=False)):
        read[number] = np.frombuffer(model.nearest(code.tobytes()), np.uint8)
    return read


def _snapped(model: LearntModel, bench: Bench) -> Predict:
    return lambda codes, actions: bench.encoder.snap(model.raw(codes, actions))[0]


def _name(objective: str) -> str:
    return "π" if objective == BITS else "π, eq. 4.3 alone"


def _discriminator_row(
    label: str, model: LearntModel, world: BlocksWorld, codes: NDArray[np.uint8]
) -> Row:
    possible = np.zeros((len(codes), len(MOVES)), np.bool_)
    possible[world.before, world.move] = True
    right = model.possible(codes[:, 0]) == possible
    return Row(label, "D: actions judged right", float(right.mean()), "", right.size,
               required=">= 0.99", thesis=THESIS_D)  # fmt: skip


def _accuracy_rows(label: str, name: str, found: Accuracy, bounded: bool) -> list[Row]:
    return [
        Row(label, f"{name}: bits right", found.bits, "", found.n,
            required=">= 0.97" if bounded else None,
            thesis=THESIS_POLICY if name.startswith("π") else None,
            note="the same network on the same codes" if "4.3" in name else None),
        Row(label, f"{name}: bits right that the move changes", found.changed, "", found.n),
        Row(label, f"{name}: whole next state exactly right", found.whole, "", found.n,
            wilson_interval(round(found.whole * found.n), found.n),
            required=">= 0.90" if bounded else None),
    ]  # fmt: skip


def _plan_rows(label: str, search: str, plans: Plans, required: str | None) -> list[Row]:
    share = plans.valid / plans.n
    spread = wilson_interval(plans.valid, plans.n)
    thesis = 1.0 if label.startswith("M1") else None
    rows = [
        Row(label, f"plans valid by the rules, {search}", share, "", plans.n, spread,
            required=required, thesis=thesis,
            note=f"{plans.shortest} as short as can be; {sum(plans.lengths)} moves in all"),
        Row(label, f"search, {search}, median", float(np.median(plans.seconds)), "s",
            len(plans.seconds), (min(plans.seconds), max(plans.seconds)),
            note="a learnt model remembers what it was asked for plans before"
            if thesis is None else None),
    ]  # fmt: skip
    if not label.startswith("M1"):
        rows.append(
            Row(label, f"states on plans that are no state's code, {search}",
                plans.hallucinated / max(plans.states, 1), "", plans.states)
        )  # fmt: skip
    return rows
