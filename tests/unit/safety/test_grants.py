"""What `--config` grants reaches the jobs, and nothing else that a scene could say."""

from __future__ import annotations

import pytest

from render import program
from scene.assets import within_reach
from scene.settings import Refused
from workflow.plan.grants import grant
from workflow.plan.jobs import _blender


def test_folders_are_allowed_one_or_more(stranger):
    other = stranger.home / "other"
    other.mkdir()
    with pytest.raises(Refused):
        within_reach(str(stranger.secret), stranger.folder)
    grant({"allow": [str(stranger.secret.parent), str(other)]})
    assert within_reach(str(stranger.secret), stranger.folder) == stranger.secret
    assert within_reach(str(other / "a.ply"), stranger.folder) == other / "a.ply"


@pytest.mark.parametrize("folder", ["absent", "a:b"])
def test_what_is_no_folder_ends_the_planning(stranger, capsys, folder):
    (stranger.project / "a:b").mkdir()
    with pytest.raises(SystemExit):
        grant({"allow": folder})
    assert "--config allow" in capsys.readouterr().err


def test_a_blender_is_what_its_program_is(stranger, monkeypatch):
    """A name is looked up, so that another program behind it renders the pictures anew."""
    monkeypatch.setenv("PATH", str(stranger.folder))
    grant({"blender": "evil.sh"})
    assert program.chosen() == "evil.sh" and program.found("evil.sh") == stranger.program
    before = _blender("evil.sh")
    stranger.program.write_text("#!/bin/sh\n")
    assert _blender("evil.sh") != before != _blender("absent")
