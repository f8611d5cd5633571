#!/usr/bin/env python3
"""Documents say what the programs do: the message reference is that of lcmtypes, links lead somewhere, and every `boxgrasp…` command
line in a document names a command and options that exist.  Usage: documents_test.py SOURCE BUILD"""
import pathlib
import re
import shlex
import subprocess
import sys

SOURCE, BUILD = map(pathlib.Path, sys.argv[1:3])
PROGRAMS = {"boxgrasp": BUILD / "client/boxgrasp", "boxgrasp-server": BUILD / "server/planner/boxgrasp-server",
            "boxgrasp-trainer": BUILD / "server/trainer/boxgrasp-trainer"}
helps = {}


def help_of(program, commands):
    key = (program, *commands)
    if key not in helps:
        run = subprocess.run([PROGRAMS[program], *commands, "--help"], capture_output=True, text=True)
        helps[key] = run.stdout if run.returncode == 0 else None
    return helps[key]


def problems_of_command(line):
    words = shlex.split(line, comments=True)
    program, words = words[0], words[1:]
    commands, text = [], help_of(program, [])
    for word in words:
        if not re.fullmatch(r"[a-z][a-z-]*", word) or not re.search(rf"^  {word}( |$)", text.partition("Subcommands:")[2], re.M):
            break
        commands.append(word)
        text = help_of(program, commands)
    if "SUBCOMMAND" in text.splitlines()[1] and not words[len(commands):][:1] == ["--help"]:
        yield f"no command '{' '.join(words[:1])}'"
    for word in words:
        option = word.split("=")[0]
        if option.startswith("--") and not re.search(rf"(^|[ ,]){re.escape(option)}\b", text, re.M):
            yield f"no option {option}"


def commands_in(text):
    """Command lines in indented or fenced blocks, continuation lines joined."""
    text = text.replace("\\\n", " ")
    for line in text.splitlines():
        line = re.sub(r"^\s*(\$ |sudo )?", "", line)
        line = re.split(r"[|;&>]|\s#", line)[0].strip()
        if re.match(r"(boxgrasp|boxgrasp-server|boxgrasp-trainer) ", line):
            yield line


def blocks(markdown):
    fenced = re.findall(r"^```[a-z]*\n(.*?)^```", markdown, re.M | re.S)
    indented = re.findall(r"(?:^    .*\n)+", re.sub(r"^```.*?^```", "", markdown, flags=re.M | re.S), re.M)
    return fenced + indented


def problems():
    expected = subprocess.run([SOURCE / "deploy/package/message_reference", SOURCE / "lcmtypes"], capture_output=True, text=True, check=True).stdout
    if (SOURCE / "docs/messages.md").read_text() != expected:
        yield "docs/messages.md is not that of lcmtypes: deploy/package/message_reference lcmtypes >docs/messages.md"
    for document in [*SOURCE.glob("*.md"), *SOURCE.glob("docs/**/*.md")]:
        text = document.read_text()
        for link in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text):
            if "://" not in link and not (document.parent / link).exists():
                yield f"{document.name}: the link {link} leads nowhere"
        for line in (line for block in blocks(text) for line in commands_in(block)):
            for problem in problems_of_command(line):
                yield f"{document.name}: '{line}': {problem}"


def main():
    found = list(problems())
    for problem in found:
        print(f"documents_test: {problem}", file=sys.stderr)
    if found:
        sys.exit(1)
    print(f"documents_test: {len(helps)} commands looked up, all as documented")


main()
