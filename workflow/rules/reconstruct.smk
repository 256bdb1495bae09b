rule reconstruct:
    input:
        particles=particles_of_segment,
    output:
        folder=part("results/{scene}/{quality}/surface/{segment}"),
    log:
        "results/{scene}/{quality}/logs/surface/{segment}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/surface/{segment}.tsv"
    priority: 20
    threads: half_the_cores
    resources:
        mem_mb=memory("reconstruct"),
        attempt=attempt_number,
        scratch="",
    params:
        spec=catalog.spec("reconstruct"),
        frames=surface("frames"),
        assets=surface("assets"),
        code=surface("code"),
        versions=surface("versions"),
        plan=surface("plan"),
        repairs=catalog.repairs("reconstruct"),
    message:
        "Reconstruct the surface of {wildcards.scene}, frames {params.frames}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --attempt {resources.attempt} --scratch={resources.scratch:q}"
        " --failed results/{wildcards.scene:q}/{wildcards.quality}/failed/surface/{wildcards.segment}"
        " -- {sys.executable:q} -m workflow.reconstruct --spec {params.spec:q} --simulation {input.particles:q}"
        " --frames {params.frames} --out @OUT --threads {threads}"
