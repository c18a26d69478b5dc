"""`pacinian view`."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import CONNECTION, TEXT, NonEmptyPath
from pacinian.cli.standard_input import call_at_end_of_input

if TYPE_CHECKING:
    import asyncio


@click.command()
@click.argument("recording", metavar="[FILE]", type=NonEmptyPath(path_type=Path), required=False)
@CONNECTION
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="0 for any free port.")
@click.option(
    "--host", type=TEXT, default="127.0.0.1", show_default=True, help="An address of this machine."
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@click.option(
    "--samples",
    is_flag=True,
    help="Render a FILE of `pacinian render` again to show its samples, which takes as long as the run.",
)
@click.option("--until-eof", is_flag=True, hidden=True, help="End when standard input closes.")
def view(
    recording: Path | None,
    connection: str | None,
    port: int,
    host: str,
    no_browser: bool,
    samples: bool,
    until_eof: bool,
) -> None:
    """Show a server live in the browser.

    Runs until Ctrl-C.

    FILE is a recording to replay instead, from this page or from `pacinian render --record`.
    """
    import asyncio

    if samples and recording is None:
        raise click.UsageError("--samples needs a FILE")

    if samples:
        click.echo(f"{recording}: rendering its samples, which takes as long as the run", err=True)

    from pacinian.viewing.browser import open_browser
    from pacinian.viewing.run import view as run

    with contextlib.ExitStack() as stack:

        def ready(url: str) -> None:
            click.echo(f"view: {url}")
            if not no_browser and (file := open_browser(url)) is not None:
                stack.callback(file.unlink, missing_ok=True)

        async def until_ended() -> None:
            ended = _make_eof_event(asyncio.get_running_loop()) if until_eof else None
            await run(
                connection,
                recording,
                samples=samples,
                host=host,
                port=port,
                ready=ready,
                ended=ended,
            )

        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(until_ended())


def _make_eof_event(loop: asyncio.AbstractEventLoop) -> asyncio.Event:
    """Return an event that is set when standard input closes, which happens when the parent process ends."""
    import asyncio

    ended = asyncio.Event()

    def end() -> None:
        with contextlib.suppress(RuntimeError):  # the loop may be closed already
            loop.call_soon_threadsafe(ended.set)

    call_at_end_of_input(end)
    return ended
