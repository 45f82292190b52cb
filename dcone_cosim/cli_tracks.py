"""The commands about measured tracks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dcone_cosim.cli_options import Json, Offline, SceneName, Settings, answer, at_work, promise

tracks_app = typer.Typer(rich_markup_mode=None)
File = Annotated[
    Path,
    typer.Argument(metavar="TRACKS", help="CSV with the columns time, marker, x, y, z: s and m, frame of the shot."),
]


@tracks_app.command()
def tracks(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run with a capture.")],
    file: File,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the results; RUN-tracks if not given.")
    ] = None,
    json: Json = False,
) -> None:
    """Lay measured tracks of markers over those of a run, with their error.

    Markers are called bullet 1, node 25 or vertex. The folder has markers.csv with the root mean square and the largest
    error of each, tracks.csv with every instant, and tracks.png.

    Exit code: 0 done, 2 bad input.
    """
    from dcone_cosim.tracks import commands, show

    done = commands.tracks(run, file, out)
    answer(json, done.content, lambda console: show.show(done, console), done.notes, done.folder)


@tracks_app.command()
def fit(
    scene: SceneName,
    file: File,
    free: Annotated[
        str,
        typer.Option(
            "--free",
            metavar="KEYS",
            help="Values to find, such as net.damping_ratio,air.thread_drag,net.youngs_modulus.",
        ),
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="Folder for the results; runs/SCENE-fit if not given.")
    ] = None,
    noise: Annotated[
        str,
        typer.Option(
            "--noise", help='Standard deviation of a measured coordinate, such as "2 mm"; estimated if not given.'
        ),
    ] = "",
    settings: Settings = None,
    json: Json = False,
    offline: Offline = False,
) -> None:
    """Estimate values of a scene from measured tracks, with intervals.

    Least squares over runs of the scene, which begin with its own values. The intervals are meant to hold 95 %, for
    measurements that err alike and apart from one another, and do so on a straight line; on nets of known values one of
    three missed, so there they are an indication. What the model gets wrong is not in them.

    Exit code: 0 done, 2 bad input, 5 a run of it failed, 6 interrupted.
    """
    promise(offline)
    from dcone_cosim.tracks import commands, show

    with at_work() as progress:
        done = commands.fit(
            scene,
            file,
            [key for key in free.split(",") if key.strip()],
            out,
            progress,
            settings or [],
            commands.noise_of(noise),
        )
    answer(json, done.content, lambda console: show.show(done, console), done.notes, done.folder)
