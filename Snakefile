import os
import sys
from functools import cache

from snakemake.utils import min_version

from common.distribution import HOME, reach_from_jobs
from workflow.catalog import Catalog
from workflow.plan.memory import estimate

min_version("9.0")
reach_from_jobs()


report: "workflow/report/workflow.rst"


catalog = Catalog(
    HOME,
    config,
    workflow.resource_settings.cores or os.cpu_count() or 1,
    lambda: workflow.dryrun,
)


localrules:
    scenes,


wildcard_constraints:
    scene=r".+",
    quality="draft|standard|final|budget|accuracy",
    segment=r"[0-9][0-9][0-9]+",
    block=r"[0-9][0-9][0-9]+",
    study=r".+",
    trial=r"[0-9a-f]{8}",
    repeat=r"[0-9]+",


rule scenes:
    log:
        ".snakemake/log/scenes.log",
    message:
        "Films that can be made"
    shell:
        "{sys.executable:q} -m workflow.catalog 2>&1 | tee {log:q}"


include: "workflow/rules/common.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/reconstruct.smk"
include: "workflow/rules/foam.smk"
include: "workflow/rules/render.smk"
include: "workflow/rules/film.smk"
include: "workflow/rules/wedge.smk"
include: "workflow/rules/study_common.smk"
include: "workflow/rules/study.smk"
