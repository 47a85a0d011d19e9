# SPDX-License-Identifier: Apache-2.0
"""Settings of the whole suite."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest
from hypothesis import settings
from tamp_runtime.domain import release_domain, reserve_domain

# No test is about speed: benchmarks measure it.
settings.register_profile("any_speed", deadline=None)
settings.load_profile("any_speed")

# Tests that need no domain of their own still hear no other graph and no other worker.
os.environ["ROS_DOMAIN_ID"] = str(reserve_domain())


@pytest.fixture
def domain_id(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A DDS domain of the test's own, also for the processes that it starts."""
    domain = reserve_domain()
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    yield domain
    release_domain(domain)
