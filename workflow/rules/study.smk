rule trial:
    input:
        films=films_of_trial,
    output:
        folder=directory("results/studies/{study}/{trial}/{repeat}"),
    log:
        "results/studies/{study}/logs/{trial}_{repeat}.log",
    threads: lambda wildcards: study_plan(wildcards).study.threads
    resources:
        mem_mb=lambda wildcards: estimate(
            study_plan(wildcards).study.stage, study_plan(wildcards).scene(wildcards.trial)
        ),
    params:
        spec=study_spec("trial"),
        frames=study("trial", "frames"),
        assets=study("trial", "assets"),
        code=study("trial", "code"),
        versions=study("trial", "versions"),
        plan=study("trial", "plan"),
        repairs=study_repairs("trial"),
        stage=lambda wildcards: study_plan(wildcards).study.stage,
        limit=lambda wildcards: f"limit {study_plan(wildcards).study.limit:g}",
        command=lambda wildcards: study_plan(wildcards).command(wildcards.trial),
    message:
        "Trial {wildcards.trial} of {wildcards.study}, repeat {wildcards.repeat}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --failed results/studies/{wildcards.study:q}/failed/{wildcards.trial}_{wildcards.repeat}"
        " -- {sys.executable:q} -m workflow.study.trial --stage {params.stage} --{params.limit} --out @OUT"
        " -- {sys.executable:q} -m {params.command:q}"


rule study:
    input:
        trials=trials_of_study,
    output:
        folder=report(
            directory("studies/{study}"),
            patterns=["{file,work_precision}.svg", "{file,points|trials}.csv"],
            caption="../report/study.rst",
            category="Studies",
            subcategory="{study}",
            labels={"what": "{file}"},
        ),
    log:
        "results/studies/{study}/logs/study.log",
    threads: 1
    params:
        spec=study_spec("study"),
        assets=study("study", "assets"),
        code=study("study", "code"),
        versions=study("study", "versions"),
        plan=study("study", "plan"),
        repairs=study_repairs("study"),
        folder=lambda wildcards: str(study_plan(wildcards).loaded.path.parent),
    message:
        "Study studies/{wildcards.study}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --failed results/studies/{wildcards.study:q}/failed/study"
        " -- {sys.executable:q} -m workflow.study --spec {params.spec:q} --folder {params.folder:q}"
        " --trials results/studies/{wildcards.study:q} --out @OUT"
