include: "workflow/Snakefile"


localrules:
    all,


use rule scenes as all with:
    message:
        "Films that can be made"
