# SPDX-License-Identifier: Apache-2.0
"""Rows and the dictionary of a campaign, from the files of its trials."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, Final

from results_file import Row, wilson_interval

from faults.catalogue import CATALOGUE
from faults.fault import GOOD, Ending, Fault

Trial = Mapping[str, Any]

_GOOD: Final = {ending.value for ending in GOOD}
_KINDS: Final = {fault.name: fault for fault in CATALOGUE}


def problems(trial: Trial) -> list[str]:
    """What is bad about a trial, each in a few words; empty if nothing is."""
    fault = _KINDS.get(trial["fault"])
    found = []
    if trial["ending"] not in _GOOD and not (fault and _excused(trial, fault)):
        found.append(trial["ending"])
    elif fault and fault.transient and trial["ending"] != Ending.REACHED.value:
        found.append("not reached")
    found += [name for name in ("untrue", "stuck", "poisoned") if trial[name]]
    return found


def command_of(trial: Trial) -> str:
    """The one command that runs a trial again."""
    return f"make eval-faults ONLY={trial['fault']} PHASE={trial['phase']} SEED={trial['seed']}"


def make_rows(trials: Sequence[Trial]) -> list[Row]:
    """The published rows."""
    n = len(trials)
    kinds = {trial["fault"] for trial in trials}
    good = sum(trial["ending"] in _GOOD for trial in trials)
    seen = [trial for trial in trials if not _excused(trial, _KINDS[trial["fault"]])]
    passing = [trial for trial in trials if _KINDS[trial["fault"]].transient and trial["injected"]]
    reached = sum(trial["ending"] == Ending.REACHED.value for trial in passing)
    everything, injected = "all kinds of faults", sum(trial["injected"] for trial in trials)
    rows = [
        Row(everything, "kinds of faults", len(kinds), "", n, required=">= 60"),
        Row(everything, "trials", n, "", n,
            note=f"{injected} came as far as the phase in which the fault begins"),
        Row(everything, "reached, or refused with the cause named", good / n, "", n,
            wilson_interval(good, n), ">= 0.99", note="95% Wilson interval"),
        _count(everything, "reached", trials, Ending.REACHED),
        _count(everything, "refused with the cause named", trials, Ending.REFUSED),
        _count(everything, "refused with another sentence", trials, Ending.WRONG_SENTENCE),
        _count(everything, "hung: no answer in 60 s, none to a cancel in 10 s", trials,
               Ending.HUNG, "<= 0"),
        _count(everything, "nodes that died by themselves", trials, Ending.NODE_DIED, "<= 0"),
        _count("what a camera can tell", "false success", seen, Ending.FALSE_SUCCESS, "<= 0"),
        _count("what no camera can tell", "false success",
               [trial for trial in trials if _KINDS[trial["fault"]].unseen],
               Ending.FALSE_SUCCESS, None,
               "; ".join(sorted({f"{f.name}: {f.unseen}" for f in CATALOGUE if f.unseen}))),
        Row("afterwards", "stuck: a plain task fails until the world is reset",
            sum(bool(trial["stuck"]) for trial in trials), "", n, required="<= 0"),
        Row("afterwards", "poisoned: a plain task fails even then",
            sum(bool(trial["poisoned"]) for trial in trials), "", n, required="<= 0"),
        Row("answers", "say of the arm what is not so",
            sum(bool(trial["untrue"]) for trial in trials), "", n),
    ]  # fmt: skip
    if passing:
        rows.append(
            Row("transient faults, up to 5 s", "goal reached", reached / len(passing), "",
                len(passing), wilson_interval(reached, len(passing)), ">= 0.95",
                note="95% Wilson interval; with what is harmless for good, such as other labels")
        )  # fmt: skip
    return rows


def dictionary(trials: Sequence[Trial]) -> list[dict[str, Any]]:
    """Fault × phase × outcome × sentence, in the catalogue's order; trials that agree are one."""
    order = {fault.name: number for number, fault in enumerate(CATALOGUE)}
    entries: dict[tuple[str, str, str, str], list[Trial]] = defaultdict(list)
    for trial in sorted(trials, key=lambda item: (order[item["fault"]], item["trial"])):
        key = (trial["fault"], trial["phase"], trial["ending"], trial["status"])
        entries[key].append(trial)
    return [
        {
            "fault": fault,
            "what": _KINDS[fault].what,
            "phase": phase,
            "ending": ending,
            "status": status,
            "n": len(alike),
            "sentence": alike[0]["message"],
            "causes": alike[0]["causes"][:1],
            "bad": sorted({problem for trial in alike for problem in problems(trial)}),
            "again": next((command_of(trial) for trial in alike if problems(trial)), ""),
        }
        for (fault, phase, ending, status), alike in entries.items()
    ]


def _count(
    name: str,
    metric: str,
    trials: Sequence[Trial],
    ending: Ending,
    required: str | None = None,
    note: str | None = None,
) -> Row:
    count = sum(trial["ending"] == ending.value for trial in trials)
    return Row(name, metric, count, "", len(trials), required=required, note=note)


def _excused(trial: Trial, fault: Fault) -> bool:
    """A wrong claim that no camera could have known better."""
    return bool(fault.unseen) and trial["ending"] == Ending.FALSE_SUCCESS.value
