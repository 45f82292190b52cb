"""`dcone cache`: what is kept of built FMUs, and how it is cleared away."""

from __future__ import annotations

import time as clock
from typing import Annotated

import typer

from dcone_cosim.exits import reader_may_leave

cache_app = typer.Typer(help="Look at the FMUs that are kept, or clear them away.", rich_markup_mode=None)


@cache_app.callback(invoke_without_command=True)
def cache(context: typer.Context) -> None:
    """Look at the FMUs that are kept, or clear them away. Alone: the same as `list`."""
    if context.invoked_subcommand is None:
        list_kept()


@cache_app.command(name="path")
def path() -> None:
    """Where they are kept: DCONE_CACHE, or the user's cache folder."""
    from dcone_cosim.build import cache_folder

    with reader_may_leave():
        typer.echo(cache_folder())


@cache_app.command(name="list")
def list_kept(json: Annotated[bool, typer.Option("--json", help="Answer as JSON.")] = False) -> None:
    """Every FMU that is kept: model, size, age, and the terms it was built with.

    One serves every scene with these terms, whatever its values.
    """
    from dcone_cosim.build import cache_folder, fault
    from dcone_cosim.cache import listing, size_of_kernels, spoken_age, spoken_size

    folder = cache_folder()
    found, now = listing(folder, fault), clock.time()
    with reader_may_leave():
        if json:
            import json as writer

            rows = [{**vars(kept), "path": str(kept.path), "age": now - kept.built} for kept in found]
            typer.echo(writer.dumps(rows, indent=1))
            return
        width = max((len(kept.path.name) for kept in found), default=0)
        for kept in found:
            about = f"{spoken_size(kept.size):>8}  {spoken_age(now - kept.built):>8}"
            typer.echo(f"{kept.path.name:{width}}  {about}  {kept.terms}")
        total = spoken_size(sum(kept.size for kept in found))
        typer.echo(f"{len(found)} FMUs, {total}, and {spoken_size(size_of_kernels(folder))} for others, in {folder}")


@cache_app.command(name="clear")
def clear_kept(
    older_than: Annotated[
        str, typer.Option("--older-than", metavar="AGE", help="Only what was built longer ago, such as 30d or 12h.")
    ] = "",
) -> None:
    """Remove FMUs and kernels that are kept; what is needed is built again. Nothing being built is touched."""
    from dcone_cosim.build import cache_folder
    from dcone_cosim.cache import age, clear, spoken_size

    count, size = clear(cache_folder(), age(older_than) if older_than else 0.0)
    with reader_may_leave():
        typer.echo(f"{count} FMUs removed, {spoken_size(size)}")
