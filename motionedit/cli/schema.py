"""The command `motionedit schema`."""

from __future__ import annotations

import click

from motionedit.cli.verbosity import verbosity_options


@click.command(
    "schema",
    epilog="""\b
    Example, for an editor that checks YAML as it is typed:
      motionedit schema edit-prioritized > edit-prioritized.schema.json""",
)
@click.argument("name", metavar="COMMAND", type=click.Choice(["normalize", "fit-pca", "edit-pc", "edit-prioritized"]))
@verbosity_options
def command(name: str) -> int:
    """Print the JSON Schema of a command's spec.

    COMMAND is normalize, fit-pca, edit-pc or edit-prioritized.
    """
    import json

    from motionedit.spec import schema_of

    click.echo(json.dumps(schema_of(name), indent=2, ensure_ascii=False))
    return 0
