# SPDX-License-Identifier: Apache-2.0
"""Goals as people type them: "please put red on blue, and nothing on stack 2".

Parsing needs no scene, so that a goal that makes no sense is refused before anything else happens;
:mod:`planner_node.goals.resolve` then finds the objects that its names mean. Every way to write a
relation comes from :data:`scene_graph.PREDICATES`; the other words are in
:mod:`planner_node.goals.language`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Final

from scene_graph import ABOVE, PREDICATES, UP, Phrase

from ..errors import InvalidGoalError
from .clauses import read_clause
from .language import BOTH, IT
from .lists import is_listed, place_of, row_before, row_of, turned_at_comma
from .objections import unclear, untold
from .parsed import ParsedRelation
from .said import EXAMPLE, Said, no_relation
from .sentences import is_heading, sentences
from .terms import Kind, Term, Words
from .told import Told

#: The object of the relation before: "red on blue, which is in stack1".
_WHICH: Final = frozenset({"which", "who"})


def parse_goal(text: str) -> tuple[ParsedRelation, ...]:
    """Reads the relations of a goal.

    Relations are separated by commas, semicolons, full stops, "and" and the like. Within a sentence
    names without a relation belong to the relation beside them ("red, blue and green in stack 1"),
    and a relation without a subject has that of the one before ("red on blue and left of green").

    Raises:
        InvalidGoalError: if the goal is empty, or a part of it is not understood; nothing is left
            out but words that are known to mean nothing.
    """
    reader = _Reader(text)
    for sentence in sentences(text):
        reader.read([read_clause(text, clause) for clause in sentence])
    return reader.finish()


class _Reader:
    """Puts the clauses of a goal together, sentence by sentence.

    Attributes:
        taken: what "take red and blue" took, until it is said where to put it.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self._told = Told(text)
        #: How many relations there were before the sentence.
        self._before = 0
        self.taken: list[Term] = []

    def read(self, sentence: Sequence[Said]) -> None:
        """Adds the relations of a sentence."""
        self._before = len(self._told.relations)
        said = self._without_rows(_in_place(turned_at_comma(sentence)))
        waiting: list[Said] = []
        subjects: list[Term] = []
        last: Said | None = None
        for number, clause in enumerate(said):
            follows = any(other.links or other.clears for other in said[number + 1 :])
            named = [other.subject for other in waiting if other.subject is not None]
            if clause.takes and is_listed(said[number + 1 :]):
                clause = replace(clause, takes=False)  # "get red and blue into stack 0"
            if clause.again:
                self._told.add_again(clause)
                continue
            if clause.takes:
                if waiting or self.taken:
                    raise no_relation(self._text, clause.words)
                assert clause.subject is not None
                self.taken = [clause.subject]
                continue
            if clause.clears:
                assert clause.subject is not None
                subjects, waiting, last = [clause.subject], [], clause
                spoken = [*named, clause.subject]
                if clause.subject.stands_for_several:
                    spoken = named or self._told.all_named(clause.subject)
                if clause.subject.words.text in _WHICH and named:
                    spoken = subjects = named[-1:]  # "the red one, which must be clear, …"
                for term in spoken:
                    self._told.clear(self._told.meant(term, None))
                self._told.subjects, self._told.object = subjects, None
                continue
            if clause.of_object and named:
                # "stack0 and stack1 have no blocks"
                assert clause.subject is not None
                for term in named:
                    phrase, denied, _, written = clause.links[0]
                    self._told.add([clause.subject], phrase, denied, written, term)
                named = []
            if clause.edge is not None:
                subjects = self._subjects_of(clause, named, subjects)
                self._told.add_edge(subjects, clause)
                waiting, last = [], clause
                continue
            if clause.links:
                clause, named = _of_topic(clause, named)
                subjects = self._subjects_of(clause, named, subjects)
                self._told.add_links(subjects, clause)
                waiting, last = [], clause
                continue
            assert clause.subject is not None
            if self.taken and last is None and not waiting and not clause.asks:
                self.taken.append(clause.subject)
            elif self._waits(clause, last, follows):
                waiting.append(clause)
            elif last is not None and last.clears:
                self._told.clear(clause.subject)
            elif last is not None and last.edge is not None:
                self._told.add_next(clause.subject, last.edge == "bottom")
            elif last is not None and last.denies(subjects):
                assert self._told.link is not None
                self._told.add(subjects, *self._told.link, clause.subject)
            elif last is not None and last.links[-1][0] == Phrase(PREDICATES[UP]):
                # Nothing stands directly on two.
                raise no_relation(self._text, clause.words)
            elif (
                self._told.object is not None
                and self._told.object.is_place
                and not clause.subject.is_place
            ):
                # "in stack 0 put red and blue"
                assert self._told.link is not None
                self._told.add([clause.subject], *self._told.link, self._told.object)
            else:
                assert self._told.link is not None
                self._told.add(subjects, *self._told.link, clause.subject)
        if waiting:
            raise no_relation(self._text, waiting[0].words)
        if self.taken and last is not None:
            raise untold(self.taken[0])

    def _without_rows(self, said: list[Said]) -> list[Said]:
        """What is left of a sentence without a tower or a row, whose relations are added."""
        for number, clause in enumerate(said):
            if clause.order is None:
                continue
            before = [other for other in said[:number] if not is_heading(other.words)]
            names, rest = row_of(said[number + 1 :])
            heading = clause
            if not names:
                before, heading, names = row_before(before, clause)
            if rest and (standing := place_of(rest[0])):
                heading, rest = replace(heading, links=(*heading.links, standing)), rest[1:]
            self._read_row(heading, clause.order, names)
            return [*before, *rest]
        return said

    def _read_row(self, heading: Said, order: tuple[str, bool], names: Sequence[Said]) -> None:
        """The relations of "from bottom to top in stack 1: red, green, blue"."""
        predicate, ascending = order
        if unfit := [item for item in names if item.subject is None]:
            raise no_relation(self._text, unfit[0].words)
        blocks = [item.subject for item in (heading, *names) if item.subject is not None]
        if len(blocks) < 2 or any(block.kind is not Kind.THE or block.is_place for block in blocks):
            raise no_relation(self._text, heading.words)
        if not ascending:
            blocks.reverse()
        phrase = Phrase(PREDICATES[predicate])
        written = Words(phrase.predicate.words, heading.words[0].offset)
        for _, _, place, _ in heading.links:
            self._told.add(blocks[:1], phrase, False, written, place)
        for first, second in pairwise(blocks):
            self._told.add([second], phrase, False, written, first)

    def finish(self) -> tuple[ParsedRelation, ...]:
        """All relations."""
        if self.taken:
            raise untold(self.taken[0])
        if not self._told.relations:
            raise InvalidGoalError(f"the goal is empty; {EXAMPLE}")
        return tuple(self._told.relations)

    def _waits(self, clause: Said, last: Said | None, follows: bool) -> bool:
        """Whether a name without a relation belongs to the next one, not to the last one."""
        assert clause.subject is not None
        if clause.asks and not follows:
            raise no_relation(self._text, clause.words)
        if last is None:
            return True
        if not follows:
            return False
        if clause.asks or last.clears:
            return True
        phrase, _, object_, _ = last.links[-1]
        if phrase.predicate.name == UP or (object_.is_place and not clause.subject.is_place):
            return True
        raise InvalidGoalError(
            "it is not clear which relation this belongs to; write every relation out",
            clause.subject.words.offset,
            clause.subject.words.text,
        )

    def _subjects_of(
        self, clause: Said, named: Sequence[Term], before: Sequence[Term]
    ) -> list[Term]:
        """The names before a clause and its own, those of the one before, or what was taken."""
        if clause.subject is None:
            if self.taken and not named:
                taken, self.taken = self.taken, []
                return taken
            if not named and not before:
                first = clause.links[0][3]
                raise InvalidGoalError("there is no block before this", first.offset, first.text)
            return list(named or before)
        pronoun = BOTH if len(self.taken) > 1 else IT
        if clause.subject.words.text in pronoun and self.taken and not named:
            taken, self.taken = self.taken, []
            return taken
        if clause.subject.stands_for_several:
            if clause.subject.bare and not named and 0 < self._before == len(self._told.relations):
                raise unclear(clause.subject)  # "Red on blue. All in stack1."
            if len(named) == (clause.subject.exact or len(named)) and len(named) > 1:
                return list(named)  # "red and blue, put them in stack1"
            return [*named, *self._told.all_named(clause.subject)]
        if clause.subject.words.text in IT and len(named) == 1:
            return list(named)  # "the red box, it goes on blue"
        if clause.subject.words.text in _WHICH and not named:
            if (
                self._told.object is None
                or self._told.object.is_place
                or self._told.object.kind is not Kind.THE
            ):
                raise unclear(clause.subject)
            return [self._told.object]
        return [*named, self._told.meant(clause.subject, None, again=bool(clause.links))]


def _of_topic(clause: Said, named: list[Term]) -> tuple[Said, list[Term]]:
    """ "blue first, red on that" with the name in front as the object of what is said of it."""
    own = clause.subject is not None and clause.subject.words.text not in IT | _WHICH | BOTH
    if not own or len(named) != 1 or len(clause.links) != 1:
        return clause, named
    phrase, denied, object_, written = clause.links[0]
    if object_.words.text not in IT or named[0].kind is not Kind.THE:
        return clause, named
    return replace(clause, links=((phrase, denied, named[0], written),)), []


def _in_place(said: list[Said]) -> list[Said]:
    """ "in stack 0, red on blue" with the place said of red as well."""
    if len(said) != 2 or said[1].subject is None or len(said[1].links) != 1:
        return said
    place = place_of(said[0])
    phrase, denied, object_, _ = said[1].links[0]
    tower = phrase.predicate.name in (UP, ABOVE) and not denied and not object_.is_place
    if place is None or said[0].edge or said[1].edge or not tower:
        return said
    inside = PREDICATES.phrases["in",]
    return [said[1], replace(said[1], links=((inside, *place[1:]),))]
