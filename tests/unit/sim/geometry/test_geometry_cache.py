"""The cache: equal calls are computed once, and trouble with the folder costs time only."""

import warnings

import numpy as np
import pytest

from sim.geometry import cache


@pytest.fixture
def calls():
    return []


@pytest.fixture
def call(calls, tmp_path, monkeypatch):
    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path / "cache"))
    source = tmp_path / "source.py"
    source.write_text("one")

    def run(function="f", arguments=None, arrays=None, source=source):
        def compute():
            calls.append(function)
            return {"result": np.arange(1000.0)}

        return cache.cached(
            function,
            compute,
            arguments=arguments or {"spacing": 0.1},
            arrays=arrays or [np.arange(3.0)],
            sources=[str(source)],
        )["result"]

    return run


def test_equal_call_is_computed_once(call, calls, tmp_path):
    np.testing.assert_array_equal(call(), call())
    assert len(calls) == 1
    assert [entry.suffix for entry in (tmp_path / "cache").iterdir()] == [".npz"]


def test_everything_that_matters_is_in_the_key(call, calls, tmp_path):
    other_source = tmp_path / "other.py"
    other_source.write_text("two")
    call()
    call(function="g")
    call(arguments={"spacing": 0.2})
    call(arrays=(np.arange(3.0) + 1e-15,))
    call(arrays=(np.arange(3),))
    call(arrays=(np.arange(3.0).reshape(3, 1),))
    call(source=other_source)
    assert len(calls) == 7


@pytest.mark.parametrize("damage", ["truncated", "empty", "flipped", "text"])
def test_damaged_entry_is_computed_and_written_again(call, calls, tmp_path, damage):
    expected = call()
    (entry,) = (tmp_path / "cache").iterdir()
    whole = entry.read_bytes()
    middle = len(whole) // 2
    entry.write_bytes(
        {
            "truncated": whole[:middle],
            "empty": b"",
            "flipped": whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :],
            "text": b"not an archive",
        }[damage]
    )
    np.testing.assert_array_equal(call(), expected)
    assert len(calls) == 2
    call()
    assert len(calls) == 2


def test_folder_that_can_not_be_made_warns_once(call, calls, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TIDEMILL_CACHE", str(tmp_path / "file" / "cache"))
    with pytest.warns(UserWarning, match="TIDEMILL_CACHE"):
        call()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        call()
    assert len(calls) == 2


def test_full_disk_leaves_nothing_behind(call, calls, tmp_path, monkeypatch):
    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.warns(UserWarning, match="No space left"):
        assert len(call()) == 1000
    assert list((tmp_path / "cache").iterdir()) == []


def test_folder_follows_the_environment(tmp_path, monkeypatch):
    monkeypatch.delenv("TIDEMILL_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == tmp_path / "tidemill"
