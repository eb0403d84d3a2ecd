"""``eurdf completion``: write what makes a shell complete commands, options, their values, robots and files."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

from eurdf.commands.command import command, option
from eurdf.commands.terminal import write_text

_DESCRIPTION = """\
Write a script that makes a shell complete commands, options, their values, names of the collection and files. Add the
line of your shell to the file beside it:

  bash  eval "$(eurdf completion bash)"       ~/.bashrc
  zsh   eval "$(eurdf completion zsh)"        ~/.zshrc, after compinit
  fish  eurdf completion fish | source        ~/.config/fish/config.fish
"""

# The first line of the words where a file may be given, too.
_FILES = ":"

#: Each asks this command for the words that go on, a line each, and adds files after `_FILES`.
_SCRIPTS = {
    "bash": """\
_eurdf() {
  local IFS=$'\\n'
  COMPREPLY=($("$1" completion bash -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
  if [ "${COMPREPLY[0]}" = : ]; then
    COMPREPLY=("${COMPREPLY[@]:1}" $(compgen -f -- "${COMP_WORDS[COMP_CWORD]}"))
  fi
}
complete -o filenames -F _eurdf eurdf
""",
    "zsh": """\
_eurdf() {
  local -a found
  found=("${(@f)$($words[1] completion zsh -- "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  if [[ $found[1] == : ]]; then
    shift found
    _files
  fi
  compadd -a found
}
compdef _eurdf eurdf
""",
    "fish": """\
function __eurdf
  set -l before (commandline -opc)
  set -l word (commandline -ct)
  set -l found ($before[1] completion fish -- $before[2..-1] "$word" 2>/dev/null)
  if test "$found[1]" = :
    set -e found[1]
    __fish_complete_path "$word"
  end
  printf '%s\\n' $found
end
complete -c eurdf -f -a '(__eurdf)'
""",
}


@command(
    summary="complete commands, options and robots in bash, zsh or fish",
    description=_DESCRIPTION,
    exit_codes="0 written, 2 the command cannot run.",
    examples=("eurdf completion bash",),
)
def completion(
    shell: str = option("bash, zsh or fish", "shell", choices=tuple(_SCRIPTS), metavar="SHELL"),
    words: list[str] = option(argparse.SUPPRESS, "words", nargs="*"),
) -> int:
    """Write the script; or, of the words after ``eurdf``, what the last of them can become."""
    text = _SCRIPTS[shell] if not words else "".join(f"{each}\n" for each in _completed(*words))
    write_text(text)
    return 0


def _completed(*words: str) -> Iterator[str]:
    """The words that the last one begins."""
    for found in _possible(words[:-1], words[-1]):
        if found.startswith(words[-1]) or found == _FILES:
            yield found


def _possible(before: Sequence[str], word: str) -> Iterator[str]:
    from eurdf.commands.main import COMMANDS, command_of

    name = next((each for each in before if each in COMMANDS), None)
    if name is None:
        yield from COMMANDS
        yield from ("help", "--help", "--version", "--quiet", "--no-color")
        return
    subparsers = argparse.ArgumentParser().add_subparsers()
    command_of(name).register(subparsers, name)
    parser: argparse.ArgumentParser = subparsers.choices[name]
    options = {text: action for action in parser._actions for text in action.option_strings}
    action = options.get(before[-1])
    if action is None or action.nargs == 0:
        if word.startswith("-"):
            yield from options
            return
        action = next((each for each in parser._actions if not each.option_strings), None)
    if action is None or action.metavar == "JOINT":
        return
    if action.choices:
        yield from action.choices
        return
    yield _FILES
    if action.metavar == "PATH":
        from eurdf.collection import collection_names

        yield from collection_names()
