# SPDX-License-Identifier: Apache-2.0
"""Images of one time become one frame; the newest wins."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from perception_node.frame_pairing import FramePairing

STREAMS = ("image", "depth", "segmentation")


def feed(pairing: FramePairing, stamp: int, *streams: str) -> list[int]:
    """Stamps of the frames that came out."""
    sets = [pairing.add(stream, stamp, f"{stream}{stamp}", 0.0) for stream in streams]
    return [item.stamp for item in sets if item is not None]


def test_a_frame_is_complete_when_its_last_image_arrives() -> None:
    pairing = FramePairing(STREAMS)
    assert feed(pairing, 1, "depth", "image") == []
    frame = pairing.add("segmentation", 1, "segmentation1", 9.0)
    assert frame is not None
    assert frame.messages == {name: f"{name}1" for name in STREAMS}
    assert frame.arrival == 0.0


def test_images_of_different_times_are_never_mixed() -> None:
    pairing = FramePairing(STREAMS)
    assert feed(pairing, 1, "image") + feed(pairing, 2, "depth", "segmentation") == []
    assert feed(pairing, 2, "image") == [2]


def test_an_older_frame_that_is_completed_late_is_dropped() -> None:
    pairing = FramePairing(STREAMS)
    feed(pairing, 1, "image", "depth")
    assert feed(pairing, 2, *STREAMS) == [2]
    assert feed(pairing, 1, "segmentation") == []
    assert feed(pairing, 2, *STREAMS) == []


def test_a_stream_that_is_missing_is_named() -> None:
    pairing = FramePairing(STREAMS)
    for stamp in range(100):
        feed(pairing, stamp, "image", "depth")
    assert pairing.missing() == ("segmentation",)
    feed(pairing, 100, "depth")  # whose image is still on its way
    assert pairing.missing() == ("segmentation",)


def test_without_a_stream_that_is_always_missing_those_of_the_fullest_set_are_named() -> None:
    pairing = FramePairing(STREAMS)
    feed(pairing, 1, "image", "depth")
    feed(pairing, 2, "segmentation")
    assert pairing.missing() == ("segmentation",)


TOPICS = {stream: f"camera/{stream}" for stream in STREAMS}


def test_fault_13_a_silent_stream_is_named() -> None:
    pairing = FramePairing(STREAMS)
    for stamp in range(10):
        feed(pairing, stamp, "image", "depth")
    assert pairing.problem(TOPICS).startswith("no camera/segmentation arrives")
    feed(pairing, 10, *STREAMS)  # and one that stops later
    for stamp in range(11, 20):
        feed(pairing, stamp, "image", "segmentation")
    assert pairing.problem(TOPICS).startswith("no camera/depth arrives")


def test_fault_13_a_stream_that_stopped_after_one_more_message_is_named_as_silent() -> None:
    pairing = FramePairing(STREAMS)
    feed(pairing, 1, *STREAMS)
    feed(pairing, 2, "image", "depth")  # its segmentation was lost
    for stamp in range(3, 13):
        feed(pairing, stamp, "depth", "segmentation")
    assert pairing.problem(TOPICS).startswith("no camera/image arrives")


def test_fault_13_constant_stamps_of_all_streams_are_told() -> None:
    pairing = FramePairing(STREAMS)
    assert feed(pairing, 7, *STREAMS) == [7]
    for _ in range(5):
        assert feed(pairing, 7, *STREAMS) == []
    assert pairing.problem(TOPICS).startswith(
        "the stamps of camera/depth, camera/image, camera/segmentation do not advance"
    )


@pytest.mark.parametrize("complete_first", [True, False])
def test_fault_13_a_stream_with_a_constant_stamp_is_named(complete_first: bool) -> None:
    pairing = FramePairing(STREAMS)
    if complete_first:
        feed(pairing, 1, *STREAMS)
    for stamp in range(2, 12):
        feed(pairing, stamp, "image", "depth")
        feed(pairing, 1, "segmentation")
    assert pairing.problem(TOPICS).startswith("the stamps of camera/segmentation do not advance")


def test_fault_13_a_stream_that_is_stamped_otherwise_is_named() -> None:
    pairing = FramePairing(STREAMS)
    for stamp in range(100, 2000, 100):
        feed(pairing, stamp, "image", "segmentation")
        feed(pairing, stamp + 33, "depth")
    assert pairing.problem(TOPICS).startswith("camera/depth arrives with other stamps than")


def test_what_comes_too_late_for_its_set_completes_none_and_is_named() -> None:
    pairing = FramePairing(STREAMS)
    for stamp in range(60):  # ten a second
        now = stamp / 10
        for stream in ("image", "segmentation"):
            assert pairing.add(stream, stamp, "message", now) is None
        assert pairing.add("depth", stamp - 20, "message", now) is None
    assert pairing.problem(TOPICS).startswith("camera/depth arrives with other stamps than")
    assert "more than 1 s after" in pairing.problem(TOPICS)


def test_stamps_that_start_anew_advance() -> None:
    pairing = FramePairing(STREAMS)
    feed(pairing, 10**12, *STREAMS)
    for stamp in range(10):
        feed(pairing, stamp, "image", "depth")
    assert pairing.problem(TOPICS).startswith("no camera/segmentation arrives")


def test_a_camera_whose_clock_starts_anew_is_followed() -> None:
    pairing = FramePairing(STREAMS)
    assert feed(pairing, 10**12, *STREAMS) == [10**12]
    assert feed(pairing, 5, *STREAMS) == [5]


def test_a_detector_that_takes_half_a_second_is_waited_for() -> None:
    pairing, period = FramePairing(STREAMS), 33_000_000
    done: list[int] = []
    for number in range(90):
        now = number * period
        streams = {"image": now, "depth": now}
        if number >= 15 and number % 5 == 0:
            streams["segmentation"] = now - 15 * period
        for stream, stamp in streams.items():
            complete = pairing.add(stream, stamp, (stream, stamp), now * 1e-9)
            done += [] if complete is None else [complete.stamp]
    assert done == [number * period for number in range(0, 75, 5)]


def test_sets_that_have_waited_for_long_are_forgotten() -> None:
    pairing = FramePairing(STREAMS)
    for number in range(1000):
        pairing.add("image", number, "", number / 1000)
    assert pairing.add("depth", 1, "", 1.0) is None
    assert pairing.add("segmentation", 1, "", 1.0) is None
    assert pairing.add("depth", 999, "", 1.0) is None
    complete = pairing.add("segmentation", 999, "", 1.0)
    assert complete is not None and complete.arrival == 0.999


JITTER = st.integers(-40, 40)


@given(st.lists(st.tuples(JITTER, JITTER, JITTER), min_size=1, max_size=12), st.randoms())
def test_stamps_that_differ_by_less_than_half_a_period_are_paired(
    jitters: list[tuple[int, int, int]], chance: random.Random
) -> None:
    pairing = FramePairing(STREAMS, tolerance=90)
    for number, shifts in enumerate(jitters):
        taken = [(name, 200 * number + shift) for name, shift in zip(STREAMS, shifts)]
        chance.shuffle(taken)
        sets = [pairing.add(name, stamp, (number, stamp), 0.0) for name, stamp in taken]
        assert sets[:2] == [None, None] and sets[2] is not None
        assert {message[0] for message in sets[2].messages.values()} == {number}


def test_of_two_sets_within_the_tolerance_a_message_goes_to_the_nearer_one() -> None:
    pairing = FramePairing(("image", "depth"), tolerance=10)
    pairing.add("image", 100, "first", 0.0)
    pairing.add("image", 108, "second", 0.0)
    complete = pairing.add("depth", 106, "depth", 0.0)
    assert complete is not None and complete.messages["image"] == "second"
    assert pairing.add("depth", 119, "depth", 0.0) is None
