segment = catalog.of("simulate")


def previous_segment(wildcards):
    catalog.job("simulate", wildcards)
    plan, index = catalog.plan(wildcards.scene, wildcards.quality), int(wildcards.segment)
    return plan.job("simulate", index - 1).folder if index else []


def resume(wildcards):
    folder = previous_segment(wildcards)
    if not folder:
        return []
    plan, index = catalog.plan(wildcards.scene, wildcards.quality), int(wildcards.segment)
    return ["--resume", f"{folder}/state_{plan.job('simulate', index - 1).frames.last:05d}.npz"]


rule simulate:
    message:
        "Simulate {wildcards.scene}, frames {params.frames}"
    input:
        previous=previous_segment,
    output:
        folder=directory("results/{scene}/{quality}/simulation/{segment}"),
    params:
        spec=segment("spec"),
        frames=segment("frames"),
        assets=segment("assets"),
        code=segment("code"),
        versions=segment("versions"),
        plan=segment("plan"),
        repairs=catalog.repairs("simulate"),
        resume=resume,
        scene_folder=lambda wildcards: str(catalog.plan(wildcards.scene, wildcards.quality).scene.folder),
    log:
        "results/{scene}/{quality}/logs/simulation/{segment}.log",
    benchmark:
        "results/{scene}/{quality}/benchmarks/simulation/{segment}.tsv"
    priority: 30
    threads: half_the_cores
    resources:
        mem_mb=memory("simulate"),
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --failed results/{wildcards.scene}/{wildcards.quality}/failed/simulation/{wildcards.segment}"
        " -- {sys.executable:q} -m sim.segment --spec {params.spec:q} --folder {params.scene_folder:q}"
        " --frames {params.frames} {params.resume:q} --out @OUT --threads {threads}"
