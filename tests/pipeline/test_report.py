"""`snakemake --report`: one page with what was made."""

from __future__ import annotations


def test_a_report_shows_the_film(project):
    ran = project.snakemake("--report", "report.html", "renders/tests/pond")
    assert ran.code == 0, ran.text
    for name in ("pond.mp4", "contact.png", "plots.png", "summary.json"):
        assert f"Adding {name}" in ran.text
    page = (project.folder / "report.html").read_text(encoding="utf-8")
    assert "Film of the scene" in page
    assert "tests/pond" in page
