segment = catalog.of("simulate")
surface = catalog.of("reconstruct")
foam = catalog.of("foam")
wet = catalog.of("wet")
block = catalog.of("render")
film = catalog.of("film")


def part(folder):
    """A folder of results that a film is made of."""
    return temp(directory(folder)) if catalog.keep == "film" else directory(folder)


def plan(wildcards):
    return catalog.plan(wildcards.scene, wildcards.get("quality"))


@with_signature
def scene_folder(wildcards):
    return str(plan(wildcards).scene.folder)


@with_signature
def previous_segment(wildcards):
    """The folder that a segment goes on from; none for the first."""
    catalog.job("simulate", wildcards)
    index = int(wildcards.segment)
    return plan(wildcards).job("simulate", index - 1).folder if index else []


@with_signature
def resume(wildcards):
    """The option that names the state at the end of the segment before."""
    index = int(wildcards.segment)
    if index == 0:
        return []
    before = plan(wildcards).job("simulate", index - 1)
    return ["--resume", f"{before.folder}/state_{before.frames.last:05d}.npz"]


@with_signature
def particles_of_segment(wildcards):
    catalog.job("reconstruct", wildcards)
    return catalog.job("simulate", wildcards).folder


def segment_of_block(stage):
    """The folder of a stage that holds the frames of a block; none for a surface without fluid."""

    def folder(wildcards):
        catalog.job("render", wildcards)
        index = plan(wildcards).timeline.segment_of_block(int(wildcards.block))
        return plan(wildcards).job(stage, index).folder if plan(wildcards).parts(stage) else []

    return with_signature(folder)


def folder_option(name, stage):
    """The option of a render job that names the folder of a stage, where the film has such a stage."""

    def option(wildcards):
        folder = segment_of_block(stage)(wildcards)
        return [name, folder] if folder else []

    return with_signature(option)


@with_signature
def fluid_of_foam(wildcards):
    """The folders with the particles of a segment, and of the frame before it."""
    catalog.job("foam", wildcards)
    index = int(wildcards.segment)
    return [plan(wildcards).job("simulate", k).folder for k in range(max(0, index - 1), index + 1)]


def previous_part(stage):
    """The folder of a stage that a segment goes on from; none for the first."""

    def folder(wildcards):
        index = int(wildcards.segment)
        return plan(wildcards).job(stage, index - 1).folder if index else []

    return with_signature(folder)


def resume_part(stage):
    """The option of a job that names that folder."""

    def option(wildcards):
        folder = previous_part(stage)(wildcards)
        return ["--resume", folder] if folder else []

    return with_signature(option)


@with_signature
def fluid_of_wet(wildcards):
    """The folder with the particles, bodies and cloth of a segment."""
    catalog.job("wet", wildcards)
    return plan(wildcards).job("simulate", int(wildcards.segment)).folder


@with_signature
def fps(wildcards):
    return f"{plan(wildcards).timeline.fps:.17g}"


def all_parts(stage):
    """The folders of all jobs of a stage."""

    def folders(wildcards):
        catalog.job("film", wildcards)
        return [job.folder for job in plan(wildcards).jobs(stage)]

    return with_signature(folders)


@with_signature
def half_the_cores(wildcards):
    """Two jobs fill the machine: a segment and a block of the one before, then two blocks. Profiles of clusters, where
    nobody knows the cores of a node before, set threads themselves."""
    return max(1, (workflow.resource_settings.cores or 1) // 2)


def memory(stage):
    """A job that failed, perhaps since it had too little, gets twice as much when it is tried again."""
    return with_signature(lambda wildcards, attempt: estimate(stage, plan(wildcards).scene) * 2 ** (attempt - 1))


@with_signature
def attempt_number(wildcards, attempt):
    return attempt
