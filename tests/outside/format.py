"""Particles of all frames as one table."""

import csv
import io

from common.files import whole
from common.ply import read_points


def write(settings, made, out):
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(["frame", *settings.columns])
    for frame in made.frames:
        points = read_points(made.simulation / f"fluid_{frame:05d}.ply")
        table.writerows([frame, *row] for row in points[list(settings.columns)].tolist())
    with whole(out) as stream:
        stream.write(text.getvalue().encode())
