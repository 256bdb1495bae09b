@cache
def studies():
    """Imported only for studies: films need nothing of it."""
    from workflow.study.catalog import Studies

    return Studies(HOME, lambda: workflow.dryrun)


def study(stage, name):
    """A function of the wildcards: a field of the job that they mean."""
    return lambda wildcards: studies().of(stage)(name)(wildcards)


def study_spec(stage):
    return lambda wildcards: studies().spec(stage)(wildcards)


def study_repairs(stage):
    return lambda wildcards: studies().repairs(stage)(wildcards)


def study_plan(wildcards):
    return studies().plan(wildcards.study)


def films_of_trial(wildcards):
    """Folders of the film of the scene that a trial reads."""
    studies().job("trial", wildcards)
    return list(study_plan(wildcards).inputs(wildcards.trial).values())


def trials_of_study(wildcards):
    studies().job("study", wildcards)
    return [job.folder for job in study_plan(wildcards).trials()]
