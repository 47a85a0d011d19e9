# SPDX-License-Identifier: Apache-2.0
"""Stamps and durations as numbers: nanoseconds as integers, seconds as floats."""

from __future__ import annotations

from builtin_interfaces.msg import Duration, Time


def nanoseconds(stamp: Time | Duration) -> int:
    """A stamp or duration [ns]."""
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


def seconds(stamp: Time | Duration) -> float:
    """A stamp or duration [s], to some hundred nanoseconds for a stamp of today."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def stamp_from_nanoseconds(value: int) -> Time:
    """The stamp of a time [ns]."""
    return Time(sec=value // 10**9, nanosec=value % 10**9)


def duration_from_seconds(value: float) -> Duration:
    """The duration of a number of seconds, to the nanosecond."""
    rounded = round(value * 1e9)
    return Duration(sec=rounded // 10**9, nanosec=rounded % 10**9)
