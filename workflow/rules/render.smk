block = catalog.of("render")


def segment_of_block(stage):
    def folder(wildcards):
        catalog.job("render", wildcards)
        plan = catalog.plan(wildcards.scene, wildcards.quality)
        if stage == "reconstruct" and not plan.has_surface:
            return []
        return plan.job(stage, plan.timeline.segment_of_block(int(wildcards.block))).folder

    return folder


def surface_option(wildcards):
    folder = segment_of_block("reconstruct")(wildcards)
    return ["--surface", folder] if folder else []


rule render:
    message:
        "Render {wildcards.scene}, frames {params.frames}"
    input:
        simulation=segment_of_block("simulate"),
        surface=segment_of_block("reconstruct"),
    output:
        folder=directory("results/{scene}/{quality}/frames/{block}"),
    params:
        spec=block("spec"),
        frames=block("frames"),
        fps=lambda wildcards: f"{catalog.plan(wildcards.scene, wildcards.quality).timeline.fps:.17g}",
        assets=block("assets"),
        code=block("code"),
        versions=block("versions"),
        plan=block("plan"),
        repairs=catalog.repairs("render"),
        surface=surface_option,
    log:
        "results/{scene}/{quality}/logs/frames/{block}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/frames/{block}.tsv"
    priority: 10
    threads: half_the_cores
    resources:
        mem_mb=memory("render"),
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --failed results/{wildcards.scene}/{wildcards.quality}/failed/frames/{wildcards.block}"
        " -- {sys.executable:q} -m render --spec {params.spec:q} --simulation {input.simulation:q} {params.surface:q}"
        " --frames {params.frames} --fps {params.fps} --out @OUT --threads {threads}"
