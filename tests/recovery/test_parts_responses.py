"""Frequency responses of machines of parts, by finite elements: what is planted is named, what is after is right."""

from __future__ import annotations

import pytest

from tests.recovery.parts.cases import MACHINES
from tests.recovery.parts.responses import ResponseCase, ResponseRow, response_record


@pytest.mark.slow
@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("what", ["nothing", "nut", "payload", "mode"])
def test_a_frequency_response_of_a_machine_of_parts_is_explained(machine: str, what: str) -> None:
    row = ResponseRow(response_record(ResponseCase(machine, what, 0), limit=900.0))
    assert row.right, row.record
