# SPDX-License-Identifier: Apache-2.0
"""A neighbour lives as long as its signs of life come; of a dead one, DDS says nothing for long."""

from __future__ import annotations

from tamp_runtime.neighbour import GONE_BEATS, MUTE_BEATS, Sightings

A = frozenset({"a"})


def beats(sightings: Sightings, count: int, *living: str) -> None:
    """Time passes; everybody living gives a sign of life in each beat."""
    for _ in range(count):
        sightings.beat()
        for identity in living:
            sightings.hear(identity)


def test_who_gives_signs_of_life_is_never_gone() -> None:
    sightings = Sightings()
    beats(sightings, 1000, "a")
    assert sightings.living() == A
    assert not sightings.are_gone(A)


def test_fault_1_who_is_killed_is_gone_within_ten_seconds() -> None:
    sightings = Sightings()
    beats(sightings, 5, "a")
    beats(sightings, 19)  # of 0.5 s
    assert sightings.are_gone(A)
    assert sightings.living() == frozenset()


def test_who_stands_still_for_five_seconds_is_not_gone() -> None:
    sightings = Sightings()
    beats(sightings, 5, "a")
    beats(sightings, 12)
    assert not sightings.are_gone(A)
    beats(sightings, 1, "a")
    beats(sightings, 12)
    assert not sightings.are_gone(A)


def test_fault_1_who_was_replaced_is_gone_as_soon_as_the_other_one_lives() -> None:
    sightings = Sightings()
    beats(sightings, 5, "a")
    beats(sightings, 6)
    assert not sightings.are_gone(A)
    beats(sightings, 1, "b")
    assert sightings.are_gone(A)
    assert not sightings.are_gone(frozenset({"b"}))


def test_a_second_one_beside_the_first_replaces_nobody() -> None:
    sightings = Sightings()
    beats(sightings, 50, "a", "b")
    assert not sightings.are_gone(A)


def test_of_two_who_may_have_the_request_both_must_be_gone() -> None:
    sightings = Sightings()
    beats(sightings, 5, "a", "b")
    beats(sightings, GONE_BEATS + 1, "b")
    assert not sightings.are_gone(frozenset({"a", "b"}))


def test_requests_wait_until_somebody_lives_and_is_found() -> None:
    sightings = Sightings()
    assert not sightings.are_found(servers=1)
    sightings.hear("a")
    assert sightings.are_found(servers=1)


def test_fault_1_a_request_does_not_go_to_the_dead_one_beside_the_living() -> None:
    sightings = Sightings()
    sightings.hear("b")
    assert not sightings.are_found(servers=2), "DDS still knows the one that was killed"
    beats(sightings, 2, "b")
    assert sightings.are_found(servers=2), "by now the living one has been found, too"


def test_a_request_waits_for_one_who_is_silent_now() -> None:
    sightings = Sightings()
    beats(sightings, 5, "a")
    beats(sightings, 50)
    assert not sightings.are_found(servers=1)


def test_who_gives_no_signs_of_life_at_all_is_asked_anyhow() -> None:
    sightings = Sightings()
    beats(sightings, 100)  # nobody is there yet
    assert not sightings.are_found(servers=1), "it has only just come"
    beats(sightings, MUTE_BEATS)
    assert sightings.are_found(servers=1)
    asked = sightings.living()
    beats(sightings, 100)
    assert not sightings.are_gone(asked)
    sightings.hear("b")
    assert sightings.are_gone(asked), "a new one, that does not know the request"


def test_who_is_long_gone_is_forgotten() -> None:
    sightings = Sightings()
    for index in range(300):
        beats(sightings, 2, f"planner_{index}")
    beats(sightings, 300)
    assert not sightings._silence and not sightings._signs
