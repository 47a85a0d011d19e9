# SPDX-License-Identifier: Apache-2.0
"""What was said so far, and what it means of whom: relations, one by one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scene_graph import ABOVE, PREDICATES, UP, Phrase

from ...errors import InvalidGoalError
from ..language import NOUNS
from ..objections import check_places, unclear
from ..parsed import ParsedRelation, Said, none_but
from ..terms import Kind, Term, Words, is_any_place
from .meaning import Link
from .nominal import UPON


class Claims:
    """What was said so far.

    Attributes:
        relations: what it means.
        subjects, object, link: of the last relation.
    """

    def __init__(self) -> None:
        self.relations: list[Said] = []
        self.subjects: list[Term] = []
        self.object: Term | None = None
        self.link: tuple[Phrase, bool, Words] | None = None
        self._named: dict[str, Term] = {}
        self._kinds: list[Term] = []
        self._taken: list[Term] = []
        self._off: Link | None = None
        #: Whether the last clause was denied by its verb.
        self._denied = False
        #: A name of which nothing is said yet.
        self._mentioned: Term | None = None
        self._sides = False
        #: The last two that were said to be in one place.
        self._pair: list[Term] = []
        #: The last two that were said to be beside each other.
        self._neighbors: list[Term] = []
        #: Who stands at the bottom of a tower of which it is not yet said where it is.
        self._foot: Term | None = None
        self._footed: Term | None = None
        #: How many relations there were before the sentence.
        self._before = 0

    def _name(self, *terms: Term) -> None:
        for term in terms:
            if term.kind is Kind.THE and not term.is_place and not term.described:
                self._named.setdefault(key_of(term), term)

    def _add(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, written: Words, object_: Term
    ) -> None:
        bounded = all(term.kind is Kind.COUNT and not term.least for term in subjects)
        none = all(term.kind is Kind.NO for term in subjects)
        if is_any_place(object_) and (bounded or none):
            object_ = replace(object_, kind=Kind.EVERY)  # "at most two blocks in any stack"
        if is_any_place(object_) and not (bounded or none):
            raise unclear(object_)
        if object_.is_every_place and not denied and any(t.kind is Kind.THE for t in subjects):
            raise unclear(object_)  # one block is not in every stack
        if denied and any(term.kind in (Kind.NO, Kind.COUNT) for term in subjects):
            raise unclear(subjects[0])
        if denied and len(subjects) == 1 and subjects[0].kind is Kind.EVERY:
            one = subjects[0]
            if one.words.text == "block" and not one.but and not one.others and not one.only:
                none_of = replace(one, kind=Kind.NO, least=0, most=0, bare=False)
                subjects, denied = [none_of], False
        if len(subjects) > 1 and subjects[-1].kind is Kind.NO and subjects[-1].others:
            if set(self._named) - {key_of(term) for term in subjects}:
                raise unclear(subjects[-1])  # is who else was named meant as well?
            subjects = [replace(subject, only=True) for subject in subjects[:-1]]
        if only := [subject for subject in subjects if subject.only]:
            self._only(subjects, phrase, denied, object_, only[0])
            subjects = [replace(subject, only=False) for subject in subjects]
        if phrase == UPON and object_.is_place and not denied:
            subjects = self._lowest(subjects)
        for subject in subjects:
            subject = self._among_others(subject, phrase, object_)
            if subject.kind in (Kind.EVERY, Kind.COUNT) and not subject.others:
                self._kinds.append(subject)
            for term in (subject, object_):
                if self._is_it(term):
                    raise unclear(term)
                self._name(term)
            check_places(subject, phrase, object_, written.text)
            meaning = phrase
            together = subject.several or len(subjects) > 1
            if together and object_.is_place and phrase == UPON and not denied:
                # Several blocks on a place cannot all stand directly on it.
                meaning = phrase._replace(predicate=PREDICATES[ABOVE])
            self.relations.append(ParsedRelation(subject, meaning, object_, denied))

    def _lowest(self, subjects: Sequence[Term]) -> Sequence[Term]:
        """Of blocks that were said to stand on one another the lowest, else all of them.

        "red on blue, and both on the floor at stack 1"
        """
        upon = {
            key_of(said.subject): key_of(said.object)
            for said in self.relations
            if isinstance(said, ParsedRelation) and said.phrase == UPON and not said.negated
        }
        keys = [key_of(term) for term in subjects]
        lowest = [term for term in subjects if upon.get(key_of(term)) not in keys]
        named = all(term.kind is Kind.THE for term in subjects)
        return lowest if named and len(lowest) == 1 and len(subjects) > 1 else subjects

    def _among_others(self, subject: Term, phrase: Phrase, object_: Term) -> Term:
        """ "the rest" as all but those that were named."""
        before = self.subjects[0] if len(self.subjects) == 1 else None
        counted = before is not None and before.kind is Kind.COUNT and before.most == before.least
        if subject.kind is Kind.COUNT and subject.bare:
            if before is None or before.kind is not Kind.COUNT or before.others:
                if not object_.is_place:
                    raise unclear(subject)
                return replace(subject, bare=False)  # "at most two per stack"
            return replace(subject, words=before.words, bare=False)
        if subject.kind is Kind.EVERY and subject.others and subject.exact and counted:
            assert before is not None
            # "three in stack1, the other two in stack2": there are no more of them than these.
            number = subject.exact
            return replace(
                before, least=number, most=number, exact=before.least + number, bare=False
            )
        if subject.kind is Kind.EVERY and subject.others and counted and phrase.needs_place:
            assert before is not None
            if before.words.text == "block" and not (before.but or before.among):
                # "two in stack1, the others in stack2": all but two.
                left = before.least
                return replace(before, least=0, most=None, less=left, bare=False)
        if not subject.others:
            return subject
        if subject.kind is Kind.NO and phrase == UPON and not object_.is_place:
            on_it = [
                said.subject
                for said in self.relations
                if isinstance(said, ParsedRelation)
                and said.phrase == UPON
                and key_of(said.object) == key_of(object_)
                and not said.negated
            ]
            return replace(subject, others=False, but=tuple(on_it))
        spoken = [*self._named.values(), *self._kinds]
        if not spoken and object_.kind is Kind.THE and not object_.is_place:
            spoken = [object_]  # "all the other blocks left of yellow"
        if not spoken or any(term.kind is Kind.COUNT for term in spoken):
            raise unclear(subject)
        if subject.kind is Kind.NO and set(self._named) != set(map(key_of, self.subjects)):
            there = self._standing_in(object_) if object_.is_place else None
            if there is None or not there:
                raise unclear(subject)  # who else was named may be meant as well
            spoken = there
        return replace(subject, others=False, but=tuple(spoken))

    def _standing_in(self, place: Term) -> list[Term] | None:
        """Those that were said to stand in a place; None: of some it was not said where."""
        places: dict[str, Term] = {}
        for _ in self._named:
            for said in self.relations:
                if not isinstance(said, ParsedRelation) or said.negated:
                    continue
                if (
                    said.phrase.predicate.name not in (UP, ABOVE)
                    or said.subject.kind is not Kind.THE
                ):
                    continue
                one, other = key_of(said.subject), key_of(said.object)
                if said.object.is_place:
                    places[one] = said.object
                elif other in places:
                    places[one] = places[other]
                elif one in places:
                    places[other] = places[one]
        if not places.keys() >= self._named.keys():
            return None
        return [
            term for key, term in self._named.items() if places[key].words.base == place.words.base
        ]

    def _only(
        self, subjects: Sequence[Term], phrase: Phrase, denied: bool, object_: Term, one: Term
    ) -> None:
        found = none_but(subjects, phrase, denied, object_)
        if found is None:
            raise unclear(one)
        self.relations.append(found)

    def _nothing_on(self, term: Term) -> None:
        nothing = Term(Words("block", term.words.offset), Kind.NO, 0, 0)
        self.relations.append(ParsedRelation(nothing, UPON, term))

    def _is_it(self, term: Term) -> bool:
        return term.words.text == "it"


def key_of(term: Term) -> str:
    """A name without the words that every block has: "the red one" is "red"."""
    said = [word for word in term.words.text.split() if word not in NOUNS]
    return " ".join(said) or term.words.text


def unclear_words(words: Words) -> InvalidGoalError:
    """The error of a relation of which it is not clear who has it."""
    return InvalidGoalError(
        "it is not clear what this is said of; write every relation out", words.offset, words.text
    )
