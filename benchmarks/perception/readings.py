# SPDX-License-Identifier: Apache-2.0
"""Graphs with colours in doubt stand for several; how often the right one is among them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from results_file import Row, wilson_interval

from perception_node.name_sets import load_name_sets
from scene_graph import Relation, SceneGraph, object_name


def relations_of(graph: SceneGraph) -> list[frozenset[Relation]]:
    """The relations of each graph that a doubtful one stands for."""
    named = [[object_name(color, item.shape) for color in item.readings] for item in graph.objects]
    return [
        graph.renamed(dict(zip(graph.names, names))).relations
        for names in itertools.product(*named)
        if len(set(names)) == len(names)
    ]


def reading_rows(what: str, answers: Sequence[tuple[int, bool]]) -> list[Row]:
    """What is published as one graph, or as the few that it may be.

    Args:
        answers: to each picture how many graphs were published, and whether the right one is among
            them.
    """
    told = [(size, covered) for size, covered in answers if size]
    if not told:
        return []
    n, sizes = len(told), np.array([size for size, _ in told])
    covered, single = sum(right for _, right in told), int((sizes == 1).sum())
    of_sets = [right for size, right in told if size > 1]
    rows = [
        Row(what, "one graph or a set published", n / len(answers), "", len(answers),
            wilson_interval(n, len(answers))),
        Row(what, "right one among the published", covered / n, "", n,
            wilson_interval(covered, n), f">= {load_name_sets().coverage}",
            note="the stated coverage, by conformal prediction on seeds below 1000"),
        Row(what, "graphs of a set, mean", float(sizes.mean()), "", n,
            (float(sizes.min()), float(sizes.max()))),
        Row(what, "single graphs among the published", single / n, "", n,
            wilson_interval(single, n)),
    ]  # fmt: skip
    if of_sets:
        rows.append(
            Row(what, "right one among the published, of sets of two or more",
                sum(of_sets) / len(of_sets), "", len(of_sets),
                wilson_interval(sum(of_sets), len(of_sets)))
        )  # fmt: skip
    return rows
