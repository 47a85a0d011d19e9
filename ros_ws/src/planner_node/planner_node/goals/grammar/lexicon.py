# SPDX-License-Identifier: Apache-2.0
"""The words that goals are made of, by their kinds; see ``lexicon_of_clauses.txt``."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from scene_graph import COLORS

#: The kind of word that may be left out.
FILLER: Final = "FILLER"
#: What is written short.
_SHORT: Final = (
    ("don't", "do not"), ("n't", " not"), ("'m", " am"), ("'d", " would"), ("'ll", " will"),
    ("'re", " are"), ("'s", " 's"),
)  # fmt: skip
#: Colours beside those of :data:`scene_graph.COLORS`.
_MORE_COLORS: Final = frozenset({
    "white", "gold", "golden", "silver", "tan", "teal", "lime", "navy", "beige", "maroon",
    "olive", "turquoise", "indigo", "amber", "coral", "crimson", "scarlet", "rose", "ruby",
    "plum", "lilac", "aqua", "azure", "bronze", "copper", "cream", "peach", "salmon", "violet",
    "gray", "grey",
})  # fmt: skip
#: All colours that are known by name.
HUES: Final = frozenset(COLORS) | _MORE_COLORS


def _entries() -> dict[str, list[tuple[tuple[str, ...], str]]]:
    paths = sorted(Path(__file__).parent.glob("lexicon_*.txt"))
    text = "".join(path.read_text(encoding="utf-8") for path in paths)
    found: dict[str, list[tuple[tuple[str, ...], str]]] = {}
    for line in text.replace("\n ", " ").splitlines():
        kind, colon, listed = line.partition(": ")
        if line.startswith("#") or not colon:
            continue
        for entry in listed.split("; "):
            said, _, means = entry.partition("=")
            written = said
            for short, long in _SHORT:
                written = written.replace(short, long)
            found.setdefault(kind, []).append((tuple(written.split()), means or said))
    return found


#: By kind, the words of every entry and what they stand for.
ENTRIES: Final = _entries()
#: Words that are right as they are, and no others with a slip.
NO_SLIPS: Final = frozenset(words[0] for words, _ in ENTRIES.pop("NO_SLIPS"))
#: Words that deny what stands beside them, so that nobody may leave them out.
BAD: Final = frozenset(words[0] for words, _ in ENTRIES.pop("BAD"))
#: What courtesies speak of, as it is and as it is not, and their other words; see ``courtesy``.
COURTESY, COURTESY_DENIED, COURTLY = (
    frozenset(words[0] for words, _ in ENTRIES.pop(kind))
    for kind in ("COURTESY", "COURTESYNOT", "COURTLY")
)
#: What may be skipped, by kind; see ``skipping``.
SKIPPED: Final = {
    kind: tuple(words for words, _ in ENTRIES.pop(kind))
    for kind in (
        "FREEKIND", "FREE", "BOUND", "OPENER", "REASON", "REASONED", "VERBKIND", "STORY",
        "CARECORE", "CARELESS", "CAREDENIAL", "CAREWORD", "NEEDNOTWORD", "NEEDNOTCORE",
        "WISHWORD", "WISHCORE", "WISHGOOD", "WISHOPENS", "STARTING", "UNSAID",
        "EVERYDAY", "WHY", "REMARK", "FRONT", "LABEL",
    )
}  # fmt: skip
#: Other ways to say a relation.
RELATED: Final = tuple(ENTRIES.pop("RELATED"))
