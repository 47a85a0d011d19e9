# SPDX-License-Identifier: Apache-2.0
"""Whoever publishes pictures has room for them, and a user's own settings stay."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest
from tamp_runtime.large_messages import PROFILE, VARIABLES, make_room_for_pictures

#: Colours, depth and labels of a picture of 640x480, of two cameras [bytes].
PICTURES = 2 * 640 * 480 * (3 + 4 + 2)


def test_fast_dds_is_told_where_the_profile_is(monkeypatch: pytest.MonkeyPatch) -> None:
    environment = {VARIABLES[0]: ""}
    monkeypatch.setattr("tamp_runtime.large_messages.os.environ", environment)
    make_room_for_pictures()
    assert environment == dict.fromkeys(VARIABLES, str(PROFILE))


@pytest.mark.parametrize("name", VARIABLES)
def test_a_profile_of_the_user_s_stays(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    environment = {name: "/mine.xml"}
    monkeypatch.setattr("tamp_runtime.large_messages.os.environ", environment)
    make_room_for_pictures()
    assert environment == {name: "/mine.xml"}


def test_there_is_room_for_two_cameras() -> None:
    sizes = [
        int(item.text or 0)
        for item in ElementTree.parse(PROFILE).iter()
        if item.tag.endswith("}segment_size")
    ]
    assert sizes and min(sizes) > PICTURES
