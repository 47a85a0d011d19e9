# SPDX-License-Identifier: Apache-2.0
"""The trainings of Table 4.1 and Figure 4.9: state encoder and answerer, by setting and size."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from results_file import Row
from torch import nn

from perception_node.latent.answering import SHIFTS
from perception_node.latent.programs import ProgramNetwork, SymbolicNetwork
from perception_node.latent.qa_trainer import QaConfig, QaTrainer, ReaderConfig, ReaderTrainer
from perception_node.latent.state_encoder import StateEncoder

from .clevr.asked import (
    Vocabulary,
    all_questions,
    answered,
    asked_of,
    shares_right,
    told_to,
    without_picture,
)
from .clevr.dataset import ClevrSet
from .clevr.things import ATTRIBUTES
from .progress import progress
from .seeds import told
from .stability import reconstruction_error
from .trainings import CHECKPOINT, StoppedError

#: What was right of what was asked.
Answers = NDArray[np.bool_]
#: Thesis, Table 4.1: QA accuracy and reconstruction error, and what is required of them here.
TABLE: Final[dict[str, tuple[float, float, str | None, str | None]]] = {
    "kl": (0.932923, 0.118789, ">= 0.955", None),
    "reconstruction": (0.676227, 0.000464, None, "<= 0.00046"),
    "both": (0.931829, 0.002303, ">= 0.955", "<= 0.0023"),
}
#: Sizes o of the codes of which the table's bounds are asked: the thesis' one, and a quarter of it.
TABLE_CHANNELS: Final = (64, 16)


def train_reader(folder: Path, train: ClevrSet, config: ReaderConfig) -> ReaderTrainer:
    """A trained answerer of a folder, gone on with or taken as it is.

    Raises:
        StoppedError: by Ctrl-C.
        WeightsError: the folder holds another run.
    """
    told = told_to(config.answerer)
    vocabulary = Vocabulary.of(train, told)
    mirrored = tuple(
        (one, one.replace("left", "right"))
        for one in vocabulary.words
        if "left" in one and one.replace("left", "right") in vocabulary.words
    )
    config = replace(config, words=vocabulary.words, answers=vocabulary.answers, mirrored=mirrored)
    trainer = ReaderTrainer(asked_of(train, vocabulary, told), config)
    _run(trainer, folder, f"answerer ({config.answerer})")
    return trainer


def train_qa(
    folder: Path, config: QaConfig, reader: ReaderTrainer, start: QaTrainer | None = None
) -> QaTrainer:
    """A trained state encoder of a folder, gone on with or taken as it is.

    Args:
        folder: where it is kept.
        config: all but the answerer's.
        reader: the trained answerer; all settings begin with it.
        start: whose encoder it goes on from.

    Raises:
        StoppedError: by Ctrl-C.
        WeightsError: the folder holds another run.
    """
    config = replace(config, reader=reader.config)
    begun = start.encoder if start else None
    trainer = QaTrainer(reader.batches.asked, config, reader.reader, begun)
    _run(trainer, folder, f"questions ({config.setting}, o = {config.encoder.channels})")
    return trainer


def _run(trainer: ReaderTrainer | QaTrainer, folder: Path, title: str) -> None:
    checkpoint = folder / CHECKPOINT
    if checkpoint.exists():
        trainer.resume(checkpoint)
    with progress(title, trainer.steps, trainer.step, folder / "log.txt") as shown:
        if not trainer.run(shown.show, checkpoint):
            raise StoppedError


def baseline_rows(train: ClevrSet, test: ClevrSet) -> list[Row]:
    """What is answered without looking."""
    questions = all_questions(test)
    return [
        Row("questions", f"QA accuracy, {name}", shares_right(given, questions)[0], "",
            len(questions))
        for name, given in without_picture(train, test).items()
    ]  # fmt: skip


def reader_rows(reader: ReaderTrainer, test: ClevrSet) -> list[Row]:
    """What the answerer reads off the images themselves: as it is sure of it, and as a graph."""
    answerer, seconds = reader.answerer, np.round(reader.seconds)
    views = len(SHIFTS) * len(reader.reader.ways)
    questions = len(reader.batches.asked.questions)
    note = f"in {views} views; {seconds} s of training on {questions} questions"
    row, _ = _answers_row("images", "from images", None, reader.reader, reader.config, test, note)
    rows = [row]
    if isinstance(answerer, ProgramNetwork):
        name = "symbolic execution on the graph read off images"
        graph = SymbolicNetwork(answerer)
        rows.append(_answers_row("images", name, None, graph, reader.config, test)[0])
    return rows


def qa_rows(trainer: QaTrainer, test: ClevrSet) -> tuple[list[Row], Answers]:
    """A line of Table 4.1, families in its note, and which questions were answered right."""
    config = trainer.config
    label = f"{config.setting}, o = {config.encoder.channels}"
    full = config.encoder.channels in TABLE_CHANNELS
    accuracy, error, bound, error_bound = TABLE[config.setting]
    found = reconstruction_error(trainer.encoder.eval(), test.images)
    row, right = _answers_row(
        label, "from codes", trainer.encoder, trainer.reader, config.reader, test
    )
    if full:
        row = replace(row, required=bound, thesis=accuracy)
    alone = config.setting == "reconstruction"
    note = f"{config.epochs} epochs, {np.round(trainer.seconds)} s of training, " + (
        "read by the answerer of images as it is"
        if alone
        else "encoder and answerer going on from reconstruction and from images"
    )
    error_row = Row(
        label, "reconstruction error", found, "", len(test.images),
        required=error_bound if full else None, thesis=error if full else None, note=note,
    )  # fmt: skip
    return [row, error_row], right


def gain_rows(
    right: Mapping[str, Sequence[Answers]], channels: int, owners: NDArray[np.int64]
) -> list[Row]:
    """By how much each setting answers better than reconstruction only, question by question.

    A bound is asked of codes of :data:`TABLE_CHANNELS` only; the others belong to Figure 4.9.

    Args:
        right: by setting, of each seed which questions were answered right; without reconstruction
            only, no row.
        channels: o.
        owners: the scene of each question.
    """
    metric = "QA accuracy above reconstruction only, low end"
    required = "> 0" if channels in TABLE_CHANNELS else None
    rows = _gains(right, channels, metric, owners)
    return [replace(row, required=required) for row in rows]


def linear_rows(
    right: Mapping[str, Sequence[Answers]], channels: int, things: NDArray[np.int64]
) -> list[Row]:
    """How easily the codes of each setting are read, and against reconstruction only.

    Args:
        right: by setting, of each seed which words were named right, shape (things, attributes).
        channels: o.
        things: the scene of each thing.
    """
    rows = []
    for setting, of_seeds in right.items():
        found = np.mean(of_seeds, 0)
        shares = ", ".join(f"{n} {v:.3f}" for n, v in zip(ATTRIBUTES, found.mean(0)))
        values = [float(of_seed.mean()) for of_seed in of_seeds]
        note = f"of frozen codes; {shares}"
        row = Row(f"{setting}, o = {channels}", "words of things named right by a linear reader",
                  float(found.mean()), "", found.size, note=note)  # fmt: skip
        if len(values) > 1:
            spread = (min(values), max(values))
            row = replace(row, spread=spread, note=f"{note}; {told(values)}")
        rows.append(row)
    metric = "words named right by a linear reader above reconstruction only, low end"
    flat = {name: [item.ravel() for item in of_seeds] for name, of_seeds in right.items()}
    count = len(ATTRIBUTES)
    return rows + _gains(flat, channels, metric, np.repeat(things, count))


def _gains(
    right: Mapping[str, Sequence[Answers]],
    channels: int,
    metric: str,
    owners: NDArray[np.int64],
) -> list[Row]:
    """Of each setting against reconstruction only, in the mean of the seeds.

    What is of one owner fails together; the interval is over owners.
    """
    others, rows = right.get("reconstruction"), []
    for setting, mine in right.items():
        if others is None or setting == "reconstruction":
            continue
        of_seeds = np.asarray(mine, np.float64) - np.asarray(others, np.float64)
        gain = of_seeds.mean(0)
        mean = float(gain.mean())
        half = 1.96 * float(np.sqrt((np.bincount(owners, gain - mean) ** 2).sum())) / len(gain)
        note = f"{mean:+.4f}, 95% interval over scenes"
        if len(of_seeds) > 1:
            note += f", mean of {told(of_seeds.mean(1).tolist(), '+.4f')}"
        rows.append(Row(f"{setting}, o = {channels}", metric, mean - half, "", len(gain),
                        (mean - half, mean + half), note=note))  # fmt: skip
    return rows


def owners_of(test: ClevrSet) -> NDArray[np.int64]:
    """The scene of each question."""
    return np.repeat(np.arange(len(test.images)), [len(items) for items in test.questions])


def _answers_row(
    label: str,
    what: str,
    encoder: StateEncoder | None,
    answerer: nn.Module,
    config: ReaderConfig,
    test: ClevrSet,
    note: str = "",
) -> tuple[Row, Answers]:
    vocabulary = Vocabulary(config.words, config.answers)
    asked, questions = asked_of(test, vocabulary, told_to(config.answerer)), all_questions(test)
    numbers = answered(encoder, answerer, asked)
    share, families = shares_right([vocabulary.answers[n] for n in numbers], questions)
    notes = [f"{name} {value:.3f}" for name, value in families.items()] + [note] * bool(note)
    metric = f"QA accuracy, {what} ({config.answerer})"
    row = Row(label, metric, share, "", len(questions), note="; ".join(notes))
    return row, numbers == asked.answers
