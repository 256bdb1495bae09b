"""How the command of one job is run: as a process, into the folder of its result. `python -m workflow.job` does it."""
