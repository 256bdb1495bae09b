rule render:
    input:
        simulation=segment_of_block("simulate"),
        surface=segment_of_block("reconstruct"),
        foam=segment_of_block("foam"),
        wet=segment_of_block("wet"),
    output:
        folder=part("results/{scene}/{quality}/frames/{block}"),
    log:
        "results/{scene}/{quality}/logs/frames/{block}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/frames/{block}.tsv"
    priority: 10
    threads: half_the_cores
    resources:
        mem_mb=memory("render"),
        attempt=attempt_number,
        scratch="",
    params:
        spec=catalog.spec("render"),
        frames=block("frames"),
        fps=fps,
        assets=block("assets"),
        code=block("code"),
        versions=block("versions"),
        plan=block("plan"),
        repairs=catalog.repairs("render"),
        surface=folder_option("--surface", "reconstruct"),
        foam=folder_option("--foam", "foam"),
        wet=folder_option("--wet", "wet"),
    message:
        "Render {wildcards.scene}, frames {params.frames}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --attempt {resources.attempt} --scratch={resources.scratch:q}"
        " --failed results/{wildcards.scene:q}/{wildcards.quality}/failed/frames/{wildcards.block}"
        " -- {sys.executable:q} -m render --spec {params.spec:q} --simulation {input.simulation:q} {params.surface:q} {params.foam:q} {params.wet:q}"
        " --frames {params.frames} --fps {params.fps} --out @OUT --threads {threads}"
