"""The site of the documentation: all pages, found by search, with links that lead somewhere."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "docs" / "site"


@pytest.fixture(scope="module")
def build():
    spec = importlib.util.spec_from_file_location("build_site", SITE / "build.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_site_has_every_page(tmp_path):
    done = subprocess.run(
        [sys.executable, SITE / "build.py", tmp_path], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    for page in (ROOT / "docs").glob("*.md"):
        assert (tmp_path / page.stem / "index.html").is_file()
    assert "CONTRIBUTING" in (tmp_path / "index.html").read_text()
    reference = (tmp_path / "python" / "index.html").read_text()
    assert all(f'id="tidemill.interface.{name}"' in reference for name in ("load", "simulate", "render"))
    assert "viscos" in (tmp_path / "searchindex.js").read_text()


@pytest.mark.parametrize(
    ("link", "ends"),
    [
        ("[a](fluids.md#viscosity)", False),
        ("[a](../scenes/bowl.yaml)", False),
        ("[a](nowhere.md)", True),
        ("[a](fluids.md#no-such-heading)", True),
        ("[a](../scenes/none.yaml)", True),
    ],
)
def test_a_link_that_leads_nowhere_ends_it(build, tmp_path, link, ends):
    from sphinx.cmd.build import build_main

    source = tmp_path / "pages"
    build.gather(source)
    for page in source.glob("*.md"):
        if page.name not in ("index.md", "fluids.md"):
            page.unlink()
    text = re.sub(r"!?\[([^]]*)\]\([^)]*\)", r"\1", (source / "fluids.md").read_text())
    linked = build._LINK.sub(lambda found: f"]({build._on_site(found[1])})", link)
    (source / "fluids.md").write_text(f"{text}\n\n{linked}\n")
    (source / "index.md").write_text("# Home\n\n```{toctree}\nfluids\n```\n")
    status = build_main(["-W", "-q", "-c", str(SITE), "-b", "dirhtml", str(source), str(tmp_path / "site")])
    assert (status != 0) == ends


def test_links_follow(build):
    assert build._on_site("docs/fluids.md#viscosity") == "fluids.md#viscosity"
    assert build._on_site("../CONTRIBUTING.md#a-force") == "CONTRIBUTING.md#a-force"
    assert build._on_site("../README.md") == "index.md"
    assert build._on_site("../scenes/bowl.yaml") == "scenes/bowl.yaml"
