rule foam:
    input:
        fluid=fluid_of_foam,
        previous=previous_part("foam"),
    output:
        folder=part("results/{scene}/{quality}/foam/{segment}"),
    log:
        "results/{scene}/{quality}/logs/foam/{segment}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/foam/{segment}.tsv"
    priority: 25
    threads: half_the_cores
    resources:
        mem_mb=memory("foam"),
        attempt=attempt_number,
        scratch="",
        arch="auto",
    params:
        spec=catalog.spec("foam"),
        frames=foam("frames"),
        assets=foam("assets"),
        code=foam("code"),
        versions=foam("versions"),
        plan=foam("plan"),
        repairs=catalog.repairs("foam"),
        resume=resume_part("foam"),
    message:
        "Foam of {wildcards.scene}, frames {params.frames}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --attempt {resources.attempt} --scratch={resources.scratch:q}"
        " --failed results/{wildcards.scene:q}/{wildcards.quality}/failed/foam/{wildcards.segment}"
        " -- {sys.executable:q} -m workflow.foam --spec {params.spec:q} --simulation {input.fluid:q} {params.resume:q}"
        " --frames {params.frames} --out @OUT --threads {threads}"
        " --arch {resources.arch}"
