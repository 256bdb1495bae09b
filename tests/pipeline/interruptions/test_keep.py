"""`--config keep=film`: nothing of a film but the film."""

from __future__ import annotations

import pytest

from tests.pipeline.conftest import TARGET

KEEP = ("--config", "keep=film")


@pytest.mark.slow
def test_only_the_film_is_kept(fresh):
    fresh.make(TARGET, *KEEP)
    assert (fresh.film / "pond.mp4").exists()
    left = [path for path in fresh.results.rglob("*") if path.suffix in (".ply", ".png", ".npz")]
    assert left == []
    assert fresh.dry_run(TARGET, *KEEP).nothing
    fresh.edit("  samples: 1\n", "  samples: 2\n")
    again = fresh.make(TARGET, *KEEP)
    assert again.stages == {"simulate", "reconstruct", "render", "film"}


def test_what_else_could_be_kept_is_said(fresh):
    refused = fresh.snakemake("-n", TARGET, "--config", "keep=everything")
    assert refused.code != 0
    assert "fix: one of all, film" in refused.text
