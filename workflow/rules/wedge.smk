wedge_field = catalog.of("wedge")


rule wedge:
    input:
        films=lambda wildcards: [plan.job("film").folder for _, plan in catalog.wedge(wildcards.scene).values()],
    output:
        folder=report(
            directory("wedges/{scene}"),
            patterns=["{file,contact}.png", "{file,table}.csv"],
            caption="../report/wedge.rst",
            category="Wedges",
            subcategory="{scene}",
            labels={"what": "{file}"},
        ),
    log:
        "results/{scene}/wedge.log",
    threads: 1
    params:
        spec=catalog.spec("wedge"),
        code=wedge_field("code"),
        versions=wedge_field("versions"),
        plan=wedge_field("plan"),
        repairs=catalog.repairs("wedge"),
    message:
        "Wedge wedges/{wildcards.scene}"
    shell:
        "exec {sys.executable:q} -m workflow.job"
        " --output {output.folder:q} --log {log:q} --plan {params.plan:q}"
        " --failed results/{wildcards.scene:q}/failed/wedge"
        " -- {sys.executable:q} -m workflow.wedge --spec {params.spec:q} --out @OUT"
