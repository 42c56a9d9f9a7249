"""Each hostile file loads, or is refused with one typed error that names it: in time, and in memory."""

from __future__ import annotations

import pytest

from .case import Case, judge
from .conftest import Endings
from .corpus import list_cases
from .entrances import IN_PYTHON, ON_THE_COMMAND_LINE

CASES = list_cases()

RUNS = [(case, False) for case in CASES if case.entrance in IN_PYTHON] + [
    (case, True)
    for number, case in enumerate(CASES)
    if case.entrance in ON_THE_COMMAND_LINE and (case.entrance not in IN_PYTHON or number % 3 == 0)
]
"""Each case in Python where a function opens it; a third, and what no function opens, by the program."""


def name(value: Case | bool) -> str:
    if isinstance(value, Case):
        return value.id.encode("ascii", "backslashreplace").decode()
    return "program" if value else "python"


@pytest.mark.parametrize(("hostile_case", "by_program"), RUNS, ids=name)
def test_it_loads_or_is_refused(endings: Endings, hostile_case: Case, by_program: bool):
    ending = endings.begin(hostile_case, by_program).result()
    wrong = judge(hostile_case, ending)
    assert not wrong, wrong


def test_there_are_hundreds_of_cases():
    assert len(CASES) >= 300
    assert len({case.id for case in CASES}) == len(CASES)
    assert {case.entrance for case in CASES} == {*IN_PYTHON, *ON_THE_COMMAND_LINE}
