"""Files of cases: read again as written, or refused."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from apd_viewer.cases.case_file import (
    CaseResult,
    case_from_bytes,
    case_path,
    case_to_bytes,
    read_case,
    write_case,
)
from apd_viewer.errors import InputError

RESULT = CaseResult(
    "abc",
    {"steps": 3},
    "done",
    "Kühl – “no”.",
    {"area": 1.0 / 3.0, "volume": None, "crossings": 2},
    {"part": [0.0, 1.0]},
    {"settled": True},
    np.random.default_rng(1).normal(size=(7, 3)),
)


def same(one, other):
    return all(getattr(one, name) == getattr(other, name) for name in vars(one) if name != "U")


def test_case_from_bytes_gives_a_result_back_bit_for_bit():
    found = case_from_bytes(case_to_bytes(RESULT))
    assert same(found, RESULT)
    assert np.array_equal(found.U, RESULT.U)
    assert not found.U.flags.writeable
    assert case_to_bytes(RESULT) == case_to_bytes(found)
    light = case_from_bytes(case_to_bytes(RESULT), with_shape=False)
    assert same(light, RESULT)
    assert light.U is None


@given(st.data())
def test_case_from_bytes_lets_no_damage_go_unnoticed(data):
    content = case_to_bytes(RESULT)
    if data.draw(st.booleans()):
        broken = content[: data.draw(st.integers(0, len(content) - 1))]
    else:
        k, bit = data.draw(st.integers(0, len(content) - 1)), 1 << data.draw(st.integers(0, 7))
        broken = content[:k] + bytes([content[k] ^ bit]) + content[k + 1 :]
    with pytest.raises(ValueError, match=r"damaged|not a case result"):
        case_from_bytes(broken)


def test_read_case_says_that_a_case_is_not_there_or_damaged(tmp_path):
    with pytest.raises(InputError, match="not done, or its study was moved"):
        read_case(tmp_path, "abc")
    write_case(case_path(tmp_path, "abc"), case_to_bytes(RESULT)[:-1])
    with pytest.raises(InputError, match="run the study again"):
        read_case(tmp_path, "abc")
    write_case(case_path(tmp_path, "abc"), case_to_bytes(RESULT))
    assert same(read_case(tmp_path, "abc"), RESULT)
