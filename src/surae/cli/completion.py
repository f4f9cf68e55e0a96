"""`surae completion`."""

import click
from click.shell_completion import get_completion_class

_SHELLS = ("bash", "zsh", "fish")
#: After a line of its own, \\b keeps click from folding what follows.
_HELP = """Print what makes a shell complete surae's commands and options.

\b
bash: surae completion bash > ~/.local/share/bash-completion/completions/surae
zsh:  surae completion zsh > ~/.zfunc/_surae   (a folder of your fpath)
fish: surae completion fish > ~/.config/fish/completions/surae.fish
"""


@click.command("completion", help=_HELP)
@click.argument("shell", type=click.Choice(_SHELLS))
def command(shell: str) -> None:
    """Print what makes a shell complete surae's commands and options."""
    from surae.cli import group

    kind = get_completion_class(shell)
    assert kind is not None  # click knows all of _SHELLS
    click.echo(kind(group, {}, "surae", "_SURAE_COMPLETE").source())
