rule wet:
    input:
        simulation=fluid_of_wet,
        previous=previous_part("wet"),
    output:
        folder=part("results/{scene}/{quality}/wet/{segment}"),
    log:
        "results/{scene}/{quality}/logs/wet/{segment}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/wet/{segment}.tsv"
    priority: 25
    threads: 1
    resources:
        mem_mb=memory("wet"),
        attempt=attempt_number,
        scratch="",
    params:
        spec=catalog.spec("wet"),
        frames=wet("frames"),
        assets=wet("assets"),
        code=wet("code"),
        versions=wet("versions"),
        plan=wet("plan"),
        repairs=catalog.repairs("wet"),
        resume=resume_part("wet"),
    message:
        "Wetness of {wildcards.scene}, frames {params.frames}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --attempt {resources.attempt} --scratch={resources.scratch:q}"
        " --failed results/{wildcards.scene:q}/{wildcards.quality}/failed/wet/{wildcards.segment}"
        " -- {sys.executable:q} -m workflow.wet --spec {params.spec:q} --simulation {input.simulation:q} {params.resume:q}"
        " --frames {params.frames} --out @OUT"
