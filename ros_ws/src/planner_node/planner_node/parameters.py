# SPDX-License-Identifier: Apache-2.0
"""The parameters of planner_node: meaning, range and default in one place."""

from __future__ import annotations

from typing import Final

from tamp_runtime.parameters import ParameterSpec

from .search import ALGORITHMS, algorithm_named
from .settings import (
    AVOID,
    EACH_MOVE,
    END,
    IGNORE,
    REPRESENTATIONS,
    REQUIRE,
    STABILITY,
    VERIFY,
    WATCH,
    Settings,
)

_DEFAULTS: Final = Settings()


def _algorithm_problem(name: str) -> str:
    """one of planner_node.search.ALGORITHMS"""
    try:
        algorithm_named(name)
    except ValueError as error:
        return f"search_algorithm: {error}"
    return ""


def _verify_problem(name: str) -> str:
    """end, each_move or watch"""
    return "" if name in VERIFY else f"verify = {name!r}; there are {', '.join(VERIFY)}"


def _stability_problem(name: str) -> str:
    """avoid, require or ignore"""
    return "" if name in STABILITY else f"stability = {name!r}; there are {', '.join(STABILITY)}"


def _representation_problem(name: str) -> str:
    """one of planner_node.settings.REPRESENTATIONS"""
    if name in REPRESENTATIONS:
        return ""
    return f"representation: there is no {name!r}; known: {', '.join(REPRESENTATIONS)}"


PARAMETERS: Final = (
    ParameterSpec(
        "representation",
        _DEFAULTS.representation,
        f"What plans are made on: {', '.join(REPRESENTATIONS)}. latent takes goal images only and "
        "plans on codes of pictures by a learnt action model, without segmentation.",
        read_only=True,
        check=_representation_problem,
    ),
    ParameterSpec(
        "max_expansions",
        _DEFAULTS.max_expansions,
        "Bound of the search in expanded states; a million take a few seconds and 0.5 GB.",
        1,
        1_000_000_000,
    ),
    ParameterSpec(
        "search_algorithm",
        _DEFAULTS.search_algorithm,
        f"How plans are searched for: {', '.join(ALGORITHMS)}; "
        "all give shortest plans but bounded, which is for many blocks and which auto takes where "
        "a shortest plan takes too long; or up:ENGINE, such as "
        "up:fast-downward-opt, an engine of Unified Planning where that is installed (make peers), "
        "which has 60 s and does not count expansions.",
        check=_algorithm_problem,
    ),
    ParameterSpec(
        "min_confidence",
        _DEFAULTS.min_confidence,
        "Scene graphs below this confidence (A.2.5) are not planned on, whatever perception says.",
        0.0,
        1.0,
    ),
    ParameterSpec(
        "graph_max_age",
        _DEFAULTS.graph_max_age,
        "Scene graphs whose stamp is further than this from the node's clock are not used, nor any "
        "when none has arrived for so long in wall time [s].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "perceive_timeout",
        _DEFAULTS.perceive_timeout,
        "achieve_goal waits this long for a confident scene graph, and for news of an arm of which "
        "nothing is heard [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "view_timeout",
        _DEFAULTS.view_timeout,
        "achieve_goal waits this long for a camera that was asked to look at what is hidden from "
        "elsewhere, before blocks are moved aside to see it, and if in vain, no longer "
        "[s, wall time].",
        0.0,
        3600.0,
    ),
    ParameterSpec(
        "image_service_timeout",
        _DEFAULTS.image_service_timeout,
        "Perception has this long to interpret a goal image [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "motion_accept_timeout",
        _DEFAULTS.motion_accept_timeout,
        "The motion node has this long to take up a plan, which is published again meanwhile where "
        "it reports to be idle [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "motion_silence_timeout",
        _DEFAULTS.motion_silence_timeout,
        "A plan is given up when motion_status is silent for this long; the motion node has as "
        "long once more to come back, and then the scene is looked at again [s, wall time].",
        0.1,
        3600.0,
    ),
    ParameterSpec(
        "max_replans",
        _DEFAULTS.max_replans,
        "achieve_goal plans this often anew before it gives up.",
        0,
        1000,
    ),
    ParameterSpec(
        "verify",
        _DEFAULTS.verify,
        "When achieve_goal compares what is seen with what its plan predicts: "
        f"{END}: after the last move; {EACH_MOVE}: after each, for which the arm goes home; "
        f"{WATCH}: all the time, and the arm is stopped where they differ.",
        check=_verify_problem,
    ),
    ParameterSpec(
        "stability",
        _DEFAULTS.stability,
        "What plans put on what, by the shapes and sizes that are seen. Nothing is put on a sphere "
        f"or prism; a block on a much narrower one: {AVOID}: where no plan avoids it, and the "
        f"answer says so; {REQUIRE}: never. {IGNORE}: shapes and sizes do not matter.",
        check=_stability_problem,
    ),
    ParameterSpec(
        "max_width_ratio",
        _DEFAULTS.max_width_ratio,
        "A block more than this many times as wide as what it stands on is unstable; 1.5 goes with "
        "the motion node's max_overhang of 0.2.",
        1.0,
        10.0,
    ),
)
