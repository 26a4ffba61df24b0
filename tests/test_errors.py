"""Messages of errors."""

import pytest

from apd_viewer.errors import InputError


@pytest.mark.parametrize(
    "sign", ["\0", "\t", "\n", "\r\n", "\x1b[31m", "\x85", "\u2028", "\u2029", "\u202e", "\udcff"]
)
def test_input_error_stays_on_one_line_that_can_be_encoded(sign):
    said = str(InputError(f"“a{sign}b” is not a number."))
    assert len(said.splitlines()) == 1
    assert said.startswith("“a ")
    assert said.endswith("b” is not a number.")
    said.encode()
    assert "\x1b" not in said


def test_input_error_keeps_what_people_write():
    said = "“Größe 👩‍🚀 容器, 12\u00a0mm²” is not a number."
    assert str(InputError(said)) == said
