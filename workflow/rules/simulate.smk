rule simulate:
    input:
        previous=previous_segment,
    output:
        folder=part("results/{scene}/{quality}/simulation/{segment}"),
    log:
        "results/{scene}/{quality}/logs/simulation/{segment}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/simulation/{segment}.tsv"
    priority: 30
    threads: half_the_cores
    resources:
        mem_mb=memory("simulate"),
        attempt=attempt_number,
        scratch="",
        arch="auto",
    params:
        spec=catalog.spec("simulate"),
        frames=segment("frames"),
        assets=segment("assets"),
        code=segment("code"),
        versions=segment("versions"),
        plan=segment("plan"),
        repairs=catalog.repairs("simulate"),
        resume=resume,
        scene_folder=scene_folder,
    message:
        "Simulate {wildcards.scene}, frames {params.frames}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --attempt {resources.attempt} --scratch={resources.scratch:q}"
        " --failed results/{wildcards.scene:q}/{wildcards.quality}/failed/simulation/{wildcards.segment}"
        " -- {sys.executable:q} -m sim.segment --spec {params.spec:q} --folder {params.scene_folder:q}"
        " --frames {params.frames} {params.resume:q} --out @OUT --threads {threads}"
        " --arch {resources.arch}"
