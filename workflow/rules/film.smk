film = catalog.of("film")


def folders(stage):
    def all_parts(wildcards):
        catalog.job("film", wildcards)
        return [job.folder for job in catalog.plan(wildcards.scene).jobs(stage)]

    return all_parts


rule film:
    message:
        "Film renders/{wildcards.scene}"
    input:
        frames=folders("render"),
        simulation=folders("simulate"),
        surface=folders("reconstruct"),
    output:
        folder=directory("renders/{scene}"),
    params:
        spec=film("spec"),
        assets=film("assets"),
        code=film("code"),
        versions=film("versions"),
        plan=film("plan"),
        repairs=catalog.repairs("film"),
    log:
        "results/{scene}/film.log",
    benchmark:
        "results/{scene}/film.tsv"
    priority: 40
    threads: 1
    resources:
        mem_mb=memory("film"),
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --failed results/{wildcards.scene}/failed/film"
        " -- {sys.executable:q} -m workflow.film --spec {params.spec:q} --frames-from {input.frames:q}"
        " --simulation {input.simulation:q} --surface {input.surface:q} --out @OUT"
