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

from scene_graph import ABOVE, BESIDE, LEFT, PREDICATES, UP, Phrase

from ..errors import InvalidGoalError
from .clauses import EXAMPLE, Said, no_relation, read_clause
from .language import BOTH, DIFFERENT_PLACES, EACH_OTHER, IT, SAME_PLACE
from .lists import is_listed, turned_at_comma
from .objections import check_places, unclear, untold
from .parsed import ParsedRelation, in_one_place, none_but
from .sentences import is_heading, sentences
from .terms import Kind, Term, Words

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
        relations: what was read so far.
        taken: what "take red" took, until it is said where to put it.
    """

    def __init__(self, text: str) -> None:
        self._text = text
        self.relations: list[ParsedRelation] = []
        self.taken: Term | None = None
        #: Of the last relation; before a sentence's first one, of the sentence before.
        self._subjects: list[Term] = []
        self._object: Term | None = None
        self._link: tuple[Phrase, bool, Words] | None = None
        #: All blocks that were named, by their words.
        self._named: dict[str, Term] = {}

    def read(self, sentence: Sequence[Said]) -> None:
        """Adds the relations of a sentence."""
        said = turned_at_comma(sentence)
        for number, clause in enumerate(said):
            if clause.order is not None:
                self._read_row(clause, clause.order, said[number + 1 :])
                said = [other for other in said[:number] if not is_heading(other.words)]
                break
        waiting: list[Said] = []
        subjects: list[Term] = []
        last: Said | None = None
        for number, clause in enumerate(said):
            follows = any(other.links or other.clears for other in said[number + 1 :])
            named = [other.subject for other in waiting if other.subject is not None]
            if clause.takes and is_listed(said[number + 1 :]):
                clause = replace(clause, takes=False)  # "get red and blue into stack 0"
            if clause.takes:
                if waiting or self.taken is not None:
                    raise no_relation(self._text, clause.words)
                self.taken = clause.subject
                continue
            if clause.clears:
                assert clause.subject is not None
                subjects, waiting, last = [clause.subject], [], clause
                for term in (*named, clause.subject):
                    self._clear(self._meant(term, None))
                self._subjects, self._object = subjects, None
                continue
            if clause.of_object and named:
                # "stack0 and stack1 have no blocks"
                assert clause.subject is not None
                for term in named:
                    phrase, denied, _, written = clause.links[0]
                    self._add([clause.subject], phrase, denied, written, term)
                named = []
            if clause.links:
                subjects = self._subjects_of(clause, named, subjects)
                self._add_links(subjects, clause)
                waiting, last = [], clause
                continue
            assert clause.subject is not None
            if self._waits(clause, last, follows):
                waiting.append(clause)
            elif last is not None and last.clears:
                self._clear(clause.subject)
            elif last is not None and last.links[-1][0] == Phrase(PREDICATES[UP]):
                # Nothing stands directly on two.
                raise no_relation(self._text, clause.words)
            elif self._object is not None and self._object.is_place and not clause.subject.is_place:
                # "in stack 0 put red and blue"
                assert self._link is not None
                self._add([clause.subject], *self._link, self._object)
            else:
                assert self._link is not None
                self._add(subjects, *self._link, clause.subject)
        if waiting:
            raise no_relation(self._text, waiting[0].words)
        if self.taken is not None and last is not None:
            raise untold(self.taken)

    def _read_row(self, heading: Said, order: tuple[str, bool], names: Sequence[Said]) -> None:
        """The relations of "from bottom to top in stack 1: red, green, blue"."""
        predicate, ascending = order
        if unfit := [item for item in names if item.subject is None or item.links or item.clears]:
            raise no_relation(self._text, unfit[0].words)
        blocks = [item.subject for item in (heading, *names) if item.subject is not None]
        if len(blocks) < 2 or any(block.kind is not Kind.THE or block.is_place for block in blocks):
            raise no_relation(self._text, heading.words)
        if not ascending:
            blocks.reverse()
        phrase = Phrase(PREDICATES[predicate])
        written = Words(phrase.predicate.words, heading.words[0].offset)
        for _, _, place, _ in heading.links:
            self._add(blocks[:1], phrase, False, written, place)
        for first, second in pairwise(blocks):
            self._add([second], phrase, False, written, first)

    def finish(self) -> tuple[ParsedRelation, ...]:
        """All relations."""
        if self.taken is not None:
            raise untold(self.taken)
        if not self.relations:
            raise InvalidGoalError(f"the goal is empty; {EXAMPLE}")
        return tuple(self.relations)

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
            if self.taken is not None and not named:
                taken, self.taken = self.taken, None
                return [taken]
            if not named and not before:
                first = clause.links[0][3]
                raise InvalidGoalError("there is no block before this", first.offset, first.text)
            return list(named or before)
        if clause.subject.words.text in IT and self.taken is not None and not named:
            taken, self.taken = self.taken, None
            return [taken]
        if clause.subject.words.text in BOTH:
            return [*named, *self._all_named(clause.subject)]
        if clause.subject.words.text in _WHICH and not named:
            if self._object is None or self._object.is_place or self._object.kind is not Kind.THE:
                raise unclear(clause.subject)
            return [self._object]
        return [*named, self._meant(clause.subject, None)]

    def _all_named(self, term: Term) -> list[Term]:
        """The blocks that "both" or "all three" stands for: those that were named, if so many."""
        number = {"all three": 3, "all four": 4}.get(term.words.text, 2)
        if len(self._named) != number:
            raise unclear(term)
        return list(self._named.values())

    def _meant(self, term: Term, phrase: Phrase | None, carried: bool = False) -> Term:
        """A name itself; for "it" the one that it can only stand for.

        Args:
            phrase: the relation whose object it is; None for a subject.
            carried: the relation's subject is that of the one before.
        """
        if term.words.text not in IT:
            return term
        subject = self._subjects[0] if len(self._subjects) == 1 else None
        found: Term | None = None
        if self._object is None or self._object.is_place:
            found = subject
        elif phrase is not None and carried:
            found = self._object
        elif phrase == Phrase(PREDICATES[UP]) and self._link is not None:
            # On what already carries a block nothing else can be put.
            before, denied, _ = self._link
            found = subject if before == phrase and not denied else None
        if found is None or found.kind is not Kind.THE:
            raise unclear(term)
        return found

    def _clear(self, term: Term) -> None:
        nothing = Term(Words("block", term.words.offset), Kind.NO, 0, 0)
        self.relations.append(ParsedRelation(nothing, Phrase(PREDICATES[UP]), term))

    def _add_links(self, subjects: Sequence[Term], clause: Said) -> None:
        """The relations of a chain, "red on blue on green"."""
        links = clause.links
        for (phrase, denied, object_, _), (other, _, _, written) in pairwise(links):
            # Where it can be read as said of the first as well, and that is something else, it is
            # asked back: "put red left of blue on stack1".
            same = phrase == other and phrase.predicate.name in (UP, ABOVE, LEFT)
            onto = phrase.predicate.name == UP and not phrase.inverse
            if denied or object_.kind is not Kind.THE or not (same or onto):
                raise InvalidGoalError(
                    "a second relation starts here; separate relations by a comma or 'and'",
                    written.offset,
                    written.text,
                )
        carried = clause.subject is None
        for phrase, denied, object_, written in links:
            if object_.words.text in EACH_OTHER:
                if len(subjects) != 2 or phrase.predicate.name != BESIDE:
                    raise unclear(object_)
                subjects, objects = subjects[:1], subjects[1:]
            elif self._about_one_place(subjects, phrase, denied, object_):
                continue
            elif object_.words.text in BOTH:
                objects = self._all_named(object_)
            else:
                objects = [self._meant(object_, phrase, carried)]
            for one in objects:
                self._add(subjects, phrase, denied, written, one)
            self._subjects, self._object = list(subjects), objects[-1]
            self._link = (phrase, denied, written)
            subjects, carried = objects[-1:], False

    def _about_one_place(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, object_: Term
    ) -> bool:
        """Adds the relations of "red and blue in the same stack"; False where it says no such."""
        text = object_.words.text
        blocks = list(subjects)
        with_other = next((head for head in SAME_PLACE if text.startswith(f"{head} as ")), None)
        if with_other is not None:
            rest = text.removeprefix(f"{with_other} as ")
            blocks.append(self._meant(Term(Words(rest, object_.words.offset)), phrase))
        elif text in SAME_PLACE | DIFFERENT_PLACES:
            if len(blocks) == 1 and self._object is not None and not self._object.is_place:
                blocks.append(self._object)  # "red under blue, in the same stack"
        else:
            return False
        relations = in_one_place(blocks, text not in DIFFERENT_PLACES, denied)
        if relations is None or phrase != Phrase(PREDICATES[ABOVE], needs_place=True):
            raise unclear(object_)
        self.relations += relations
        self._named |= {term.words.text: term for term in blocks}
        return True

    def _add(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, written: Words, object_: Term
    ) -> None:
        if only := [subject for subject in subjects if subject.only]:
            nothing_else = none_but(subjects, phrase, denied, object_)
            if nothing_else is None:
                raise unclear(only[0])
            self.relations.append(nothing_else)
        for subject in subjects:
            if subject.others:
                if not self._named:
                    raise unclear(subject)
                if subject.kind is Kind.NO and set(self._named) != {
                    term.words.text for term in self._subjects
                }:
                    # Who else was named may be meant as well.
                    raise unclear(subject)
                subject = replace(
                    subject, others=False, but=tuple(term.words for term in self._named.values())
                )
            for term in (subject, object_):
                if term.words.text in IT:
                    raise unclear(term)
                if term.kind is Kind.THE and not term.is_place:
                    self._named.setdefault(term.words.text, term)
            check_places(subject, phrase, object_, written.text)
            meaning = phrase
            together = subject.several or len(subjects) > 1
            if together and object_.is_place and phrase == Phrase(PREDICATES[UP]) and not denied:
                # Several blocks on a place cannot all stand directly on it.
                meaning = phrase._replace(predicate=PREDICATES[ABOVE])
            self.relations.append(ParsedRelation(subject, meaning, object_, denied))
