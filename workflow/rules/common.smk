def half_the_cores(wildcards):
    """Two jobs fill the machine: a segment and a block of the one before, then two blocks."""
    return max(1, (workflow.cores or 1) // 2)


def memory(stage):
    return lambda wildcards: estimate(stage, catalog.plan(wildcards.scene, wildcards.get("quality")).scene)
