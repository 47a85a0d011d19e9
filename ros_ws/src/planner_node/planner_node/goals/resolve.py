# SPDX-License-Identifier: Apache-2.0
"""What a goal means in the scene that is seen: its names become objects and places.

"every", "no", numbers and "a" become relations of all the objects that fit, and counts of them.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from scene_graph import (
    ABOVE,
    LEFT,
    ONE_ROW,
    PREDICATES,
    UP,
    Phrase,
    Relation,
    Rows,
    Stacks,
    base_index,
    base_name,
)

from ..errors import AmbiguousObjectError, InvalidGoalError, PlannerError, UnknownObjectError
from .goal import Count, Goal
from .language import NOUNS
from .names import fitting_names, resolve_name
from .now import Now, needs_state
from .parsed import Changed, Parsed, ParsedRelation, Said
from .resolve_places import check_sides, unknown_place
from .terms import Kind, Term, Words


@dataclass(frozen=True)
class _Scene:
    """What there is: blocks, places, and how they stand, as far as that is known."""

    names: Sequence[str]
    stack_count: int | None
    rows: Rows
    now: Stacks | None

    def known(self, words: Words) -> Now:
        """How the blocks stand; raises InvalidGoalError where that is not known."""
        if self.now is None or self.rows.count > 1:
            raise needs_state(words)
        return Now(self.now, self.rows, lambda term: _resolve_term(term, self))


def resolve_goal(
    parsed: Parsed | Sequence[Said],
    names: Sequence[str],
    stack_count: int | None = None,
    rows: Rows = ONE_ROW,
    now: Stacks | None = None,
) -> Goal:
    """Finds the objects that the names of a parsed goal mean; repeated relations count once.

    Args:
        stack_count: how many places the scene has; None where any may exist.
        rows: how they lie.
        now: how the blocks stand; None: a goal that depends on it is refused.

    Raises:
        UnknownObjectError: if a name fits no object and no place of the scene.
        AmbiguousObjectError: if a name fits several.
        InvalidGoalError: if numbers of blocks are related in a way that is not understood, or the
            text may be read in several ways that mean different goals.
    """
    scene = _Scene(names, stack_count, rows, now)
    readings = parsed.readings if isinstance(parsed, Parsed) else (tuple(parsed),)
    goals: dict[tuple[frozenset[Relation], frozenset[Count]], Goal] = {}
    error: PlannerError | None = None
    for reading in readings:
        try:
            goal = _resolve(reading, scene)
        except (UnknownObjectError, AmbiguousObjectError, InvalidGoalError) as caught:
            error = error or caught
            continue
        goals.setdefault((frozenset(goal.relations), frozenset(goal.counts)), goal)
    if len(goals) > 1:
        told = "; or: ".join(map(str, goals.values()))
        raise InvalidGoalError(f"it may mean: {told}; write it so that only one is meant")
    if not goals:
        assert error is not None
        raise error
    return next(iter(goals.values()))


def _resolve(said: Sequence[Said], scene: _Scene) -> Goal:
    relations: dict[Relation, None] = {}
    counts: dict[Count, None] = {}
    for item in said:
        if isinstance(item, Changed):
            continue
        check_sides((item.subject, item.object), scene.rows)
        subjects = _resolve_term(item.subject, scene)
        objects = _resolve_term(item.object, scene)
        if item.object.is_place and item.phrase.predicate.name == LEFT:
            item, objects = _aside(item, objects[0], scene)
        for meaning in _meanings(item, subjects, objects):
            if isinstance(meaning, Count):
                counts[meaning] = None
            else:
                relations[meaning] = None
    moved = frozenset(relation.subject for relation in relations)
    for item in said:
        if isinstance(item, Changed):
            now = scene.known(item.words)
            relations |= dict.fromkeys(now.changed(item, moved))
    return Goal(tuple(relations), tuple(counts), scene.rows)


def _aside(
    item: ParsedRelation, place: str, scene: _Scene
) -> tuple[ParsedRelation, tuple[str, ...]]:
    """ "left of stack2": in one of the places there."""
    words, index = item.object.words, base_index(place)
    assert index is not None
    if scene.stack_count is None or scene.rows.count > 1:
        raise InvalidGoalError(
            f"it is not known which places are beside {place}; name them", words.offset, words.text
        )
    beside = range(index + 1, scene.stack_count) if item.phrase.inverse else range(index)
    if not beside:
        side = "right" if item.phrase.inverse else "left"
        raise InvalidGoalError(f"there is no place {side} of {place}", words.offset, words.text)
    some = replace(item.object, kind=Kind.COUNT)
    inside = Phrase(PREDICATES[ABOVE], needs_place=True)
    return replace(item, phrase=inside, object=some), tuple(map(base_name, beside))


def _resolve_term(term: Term, scene: _Scene) -> tuple[str, ...]:
    """The one that is meant, or all that fit where it says how many of them."""
    names, stack_count = scene.names, scene.stack_count
    if term.described is not None:
        all_fitting = functools.partial(fitting_names, term.words, names, stack_count, every=True)
        return scene.known(term.words).described(term, all_fitting)
    if term.kind is Kind.THE:
        return (resolve_name(term.words, names, stack_count),)
    left_out = {name for one in term.but for name in _left_out(one, term, scene)}
    if term.is_every_place:
        if stack_count is None:
            raise unknown_place(term.words, None)
        every = [base_name(index) for index in range(stack_count)]
        if term.exact not in (None, stack_count):
            raise AmbiguousObjectError(
                term.words.text, every, f"at offset {term.words.offset}: there are {stack_count} "
                f"places, not {term.exact}; name the ones that are meant",
            )  # fmt: skip
        return tuple(name for name in every if name not in left_out)
    if term.among:
        return tuple(resolve_name(words, names, stack_count) for words in term.among)
    fitting = fitting_names(term.words, names, stack_count, every=True)
    found = tuple(name for name in fitting if name not in left_out)
    if term.exact is not None and len(found) != term.exact:
        raise AmbiguousObjectError(
            term.words.text,
            found,
            f"at offset {term.words.offset}: not {term.exact} but {len(found)} are called "
            f"'{term.words.text}': {', '.join(found)}; name the ones that are meant",
        )
    return found


def _left_out(term: Term, every: Term, scene: _Scene) -> tuple[str, ...]:
    """Those that "every box except the red one" leaves out: they are boxes too, if any fit."""
    if not every.is_place and term.described is None:
        try:
            group = fitting_names(every.words, scene.names, scene.stack_count, every=True)
            return _resolve_term(term, replace(scene, names=group))
        except UnknownObjectError:
            pass
    return _resolve_term(term, scene)


def _meanings(
    item: ParsedRelation, subjects: Sequence[str], objects: Sequence[str]
) -> Iterator[Relation | Count]:
    """What is said of two groups, as relations that have to hold and as numbers of them."""
    subject, object_ = item.subject, item.object
    if object_.kind is Kind.NO or (object_.kind is Kind.COUNT and object_.most is not None):
        raise _not_understood(object_)
    if item.negated and subject.kind in (Kind.NO, Kind.COUNT):
        raise _not_understood(subject)
    denied = item.negated or subject.kind is Kind.NO
    # Who is on no red block is on none of them: every one is looked at by itself.
    one_object_each = object_.kind is Kind.EVERY or denied
    one_subject_each = subject.kind in (Kind.EVERY, Kind.NO)
    found = False
    for some_objects in [(one,) for one in objects] if one_object_each else [tuple(objects)]:
        for some_subjects in (
            [(one,) for one in subjects] if one_subject_each else [tuple(subjects)]
        ):
            pairs = [(one, other) for one in some_subjects for other in some_objects]
            if subject.kind is not Kind.THE or object_.kind is not Kind.THE:
                # A block that fits both names is not related to itself.
                pairs = [(one, other) for one, other in pairs if one != other]
            if pairs:
                found = True
                relations = tuple(_related(item, pair, denied) for pair in pairs)
                yield from _of_group(item, relations, some_subjects, some_objects)
    if not found:
        raise InvalidGoalError(
            "there is nothing that this can be said of", subject.words.offset, subject.words.text
        )


def _related(item: ParsedRelation, pair: tuple[str, str], denied: bool) -> Relation:
    predicate = item.phrase.predicate
    who = item.subject
    nothing = who.kind is Kind.NO and who.words.text in NOUNS and not who.but
    if nothing and item.phrase == Phrase(PREDICATES[UP]):
        # Where nothing is on it, nothing is above it either, which is easier to search for.
        predicate = PREDICATES[ABOVE]
    if denied:
        predicate = PREDICATES.negation(predicate)
    subject, object_ = reversed(pair) if item.phrase.inverse else pair
    return Relation(subject, predicate.name, object_)


def _of_group(
    item: ParsedRelation,
    relations: tuple[Relation, ...],
    subjects: Sequence[str],
    objects: Sequence[str],
) -> Iterator[Relation | Count]:
    """All of the relations, or as many as the subject or the object says."""
    subject, object_ = item.subject, item.object
    least = most = len(relations)
    if subject.kind is Kind.COUNT and (subject.least, subject.most) != (1, None):
        if len(objects) > 1:
            # Of pairs, it is not their number that is said.
            raise _not_understood(object_)
        least, most = subject.least, min(most, most if subject.most is None else subject.most)
        if subject.less:
            least = most = max(0, len(relations) - subject.less)
    elif Kind.COUNT in (subject.kind, object_.kind):
        least = 1
    if least == len(relations):
        yield from relations
    else:
        yield Count(_told(item, subjects, objects, least, most), relations, least, most)


def _told(
    item: ParsedRelation, subjects: Sequence[str], objects: Sequence[str], least: int, most: int
) -> str:
    """How a count is told: "exactly 3 of red_box, blue_box, … above stack1"."""
    number = f"exactly {least}" if least == most else f"at least {least}"
    if 0 < least < most < len(subjects):
        number = f"{least} to {most}"
    if least == 0:
        number = f"at most {most}"
    phrase = item.phrase
    words = phrase.predicate.inverse_phrases[0] if phrase.inverse else phrase.predicate.words
    return f"{number} of {', '.join(subjects)} {words} {' or '.join(objects)}"


def _not_understood(term: Term) -> InvalidGoalError:
    return InvalidGoalError(
        "a number of blocks is not understood here; name them one by one",
        term.words.offset,
        term.words.text,
    )
