rule film:
    input:
        frames=all_parts("render"),
        simulation=all_parts("simulate"),
        surface=all_parts("reconstruct"),
        foam=all_parts("foam"),
        wet=all_parts("wet"),
    output:
        folder=report(
            directory("renders/{scene}"),
            patterns=["{file,[^/]+}.mp4", "{file,contact|plots}.png", "{file,summary}.json"],
            caption="../report/film.rst",
            category="Films",
            subcategory="{scene}",
            labels={"what": "{file}"},
        ),
    log:
        "results/{scene}/film.log",
    benchmark:
        "results/{scene}/film.tsv"
    priority: 40
    threads: 1
    resources:
        mem_mb=memory("film"),
        attempt=attempt_number,
        scratch="",
    params:
        spec=catalog.spec("film"),
        assets=film("assets"),
        code=film("code"),
        versions=film("versions"),
        plan=film("plan"),
        repairs=catalog.repairs("film"),
    message:
        "Film renders/{wildcards.scene}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --attempt {resources.attempt} --scratch={resources.scratch:q}"
        " --failed results/{wildcards.scene:q}/failed/film"
        " -- {sys.executable:q} -m workflow.film --spec {params.spec:q} --frames-from {input.frames:q}"
        " --simulation {input.simulation:q} --surface {input.surface:q}"
        " --foam {input.foam:q} --wet {input.wet:q} --out @OUT"
