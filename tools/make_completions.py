#!/usr/bin/env python3
"""Makes the completions for bash, zsh and fish from what the programs say of their own options.

    tools/make_completions.py LUXEL FOLDER    writes bash/, zsh/ and fish/ there; luxel-view lies beside LUXEL
    tools/make_completions.py --self-test     proves that bash and fish complete right, and that zsh reads its files

Commands, options and the words that an option takes are completed, and files elsewhere.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from command_help import Command, choices, read_all, run_script, takes

MOST_CHARACTERS = 90  # of a meaning beside an option
MADE = "Made by tools/make_completions.py from the help of the program."


def short(text):
    """The first part of a meaning: a line of a list of options has no room for more."""
    text = text.split("; ")[0].split(": ")[0].rstrip(".").replace("`", "")
    if len(text) > MOST_CHARACTERS:
        text = text[:MOST_CHARACTERS].rsplit(" ", 1)[0].rstrip(",") + " ..."
    return text


def options_of(command, commands):
    """luxel-view takes the options of the two commands that it calls, besides its own."""
    options = list(command.options())
    if command.name == "luxel-view":
        known = {name for option in options for name in option.names}
        for other in ("luxel bake", "luxel relight"):
            for option in next((c.options() for c in commands if c.name == other), []):
                if not known & set(option.names):
                    options.append(option)
                    known |= set(option.names)
    return options


def first_choices(command):
    """The words that the first argument can be, as the tables of `luxel bench`."""
    return choices(command.positionals[0]) if command.positionals else []


# --- bash

BASH = """# Completion of {program} in bash. {made}
_{function}()
{{
    local word=${{COMP_WORDS[COMP_CWORD]}} before="" command="" words="" first=""
    ((COMP_CWORD > 0)) && before=${{COMP_WORDS[COMP_CWORD - 1]}}
    # bash takes --uv=keep apart into three words.
    if [[ $word == "=" ]]; then
        word=""
    elif [[ $before == "=" ]] && ((COMP_CWORD > 1)); then
        before=${{COMP_WORDS[COMP_CWORD - 2]}}
    fi
    COMPREPLY=()
{commands}
    case "$command $before" in
{values}
    esac
    case "$command" in
{options}
    esac
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -f -W "$first" -- "$word")
    fi
}}
complete -o filenames -F _{function} {program}
"""
BASH_COMMAND = """    if ((COMP_CWORD > 1)); then
        command=${COMP_WORDS[1]}
    fi
    if ((COMP_CWORD == 1)); then
        mapfile -t COMPREPLY < <(compgen -W "%s" -- "$word")
        return
    fi"""
BASH_REPLIES = {"choices": 'mapfile -t COMPREPLY < <(compgen -W "{words}" -- "$word")',
                "choices files": 'mapfile -t COMPREPLY < <(compgen -f -W "{words}" -- "$word")',
                "files": 'mapfile -t COMPREPLY < <(compgen -f -- "$word")',
                "folders": 'mapfile -t COMPREPLY < <(compgen -d -- "$word")',
                "nothing": ":"}


def reply(option):
    kind, known = takes(option), choices(option)
    return f"choices {kind}" if known and kind in ("files", "folders") else kind


def bash(program, commands):
    """The file of one program: luxel with its commands, or luxel-view."""
    own = [c for c in commands if c.name.split(" ")[0] == program]
    values, options = [], []
    for command in own:
        key = command.name.partition(" ")[2]
        for option in options_of(command, commands):
            kind = reply(option)
            if kind:
                pattern = "|".join(f'"{key} {name}"' for name in option.names)
                line = BASH_REPLIES[kind.replace("folders", "files") if " " in kind else kind]
                values.append(f"        {pattern}) {line.format(words=' '.join(choices(option)))}; return ;;")
        names = " ".join(name for option in options_of(command, commands) for name in option.names)
        first = " ".join(first_choices(command))
        options.append(f'        "{key}") words="{names}" first="{first}" ;;')
    subcommands = [c for c in own if " " in c.name]
    top = [name for option in own[0].options() for name in option.names]
    words = " ".join([c.name.split(" ")[1] for c in subcommands] + top)
    return BASH.format(program=program, function=program.replace("-", "_"), made=MADE, values="\n".join(values),
                       commands=BASH_COMMAND % words if subcommands else "",
                       options="\n".join(options))


# --- zsh

# _arguments takes an action apart at colons.
ZSH_VALUES = {"": "", "files": ":VALUE:_files", "folders": ":VALUE:_files -/", "nothing": ":VALUE: ",
              "choices": ":VALUE:(WORDS)",
              "choices files": ':VALUE:{_alternative "words\\:word\\:(WORDS)" "files\\:file\\:_files"}'}


def zsh_text(text):
    for c in "\\[]:":
        text = text.replace(c, "\\" + c)
    return text.replace("'", "'\\''")


def zsh_option(option):
    """A word of _arguments: '(-o --output)'{-o,--output}'[meaning]:what:_files'."""
    action = ZSH_VALUES[reply(option)].replace("VALUE", zsh_text(option.value.replace("|", " ")))
    action = action.replace("WORDS", " ".join(choices(option)))
    meaning = f"[{zsh_text(short(option.text))}]"
    if len(option.names) == 1:
        return f"'*{option.names[0]}{meaning}{action}'"
    return f"'*'{{{','.join(option.names)}}}'{meaning}{action}'"


def zsh_arguments(command, commands, indent):
    lines = [zsh_option(option) for option in options_of(command, commands)]
    first = first_choices(command)
    lines.append(f"'1:name:({' '.join(first)})'" if first else "'*:file:_files'")
    return f" \\\n{indent}".join(["_arguments -s -S"] + lines)


def zsh(program, commands):
    own = [c for c in commands if c.name.split(" ")[0] == program]
    lines = [f"#compdef {program}", f"# {MADE}"]
    subcommands = [c for c in own if " " in c.name]
    if not subcommands:
        return "\n".join(lines + [zsh_arguments(own[0], commands, "  ")]) + "\n"
    lines += ["local -a commands", "commands=("]
    lines += [f"  '{c.name.split(' ')[1]}:{zsh_text(short(c.summary))}'" for c in subcommands] + [")"]
    lines += ["if (( CURRENT == 2 )); then", "  _describe command commands", "  compadd -- --help --version", "  return", "fi",
              "local command=$words[2]", "shift words", "(( CURRENT-- ))", 'case "$command" in']
    for c in subcommands:
        lines += [f"  {c.name.split(' ')[1]})", "    " + zsh_arguments(c, commands, "      "), "    ;;"]
    return "\n".join(lines + ["  *) _files ;;", "esac"]) + "\n"


# --- fish

FISH_VALUES = {"": "", "files": " -r -F", "folders": " -x -a '(__fish_complete_directories)'", "nothing": " -x",
               "choices": " -x -a '{words}'", "choices files": " -r -F -a '{words}'"}


def fish_text(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish_option(program, condition, option):
    names = "".join(f" -l {n[2:]}" if n.startswith("--") else f" -s {n[1:]}" for n in option.names)
    value = FISH_VALUES[reply(option)].format(words=" ".join(choices(option)))
    return f"complete -c {program}{condition}{names}{value} -d {fish_text(short(option.text))}"


def fish(program, commands):
    own = [c for c in commands if c.name.split(" ")[0] == program]
    lines = [f"# {MADE}"]
    for c in own:
        name = c.name.partition(" ")[2]
        condition = ""
        if name:
            lines.append(f"complete -c {program} -n __fish_use_subcommand -f -a {name} -d {fish_text(short(c.summary))}")
            condition = f" -n '__fish_seen_subcommand_from {name}'"
        elif program == "luxel":
            condition = " -n __fish_use_subcommand"
        lines += [fish_option(program, condition, option) for option in options_of(c, commands)]
        if first_choices(c):
            lines.append(f"complete -c {program}{condition} -f -a {fish_text(' '.join(first_choices(c)))}")
    return "\n".join(lines) + "\n"


# --- all

def files(commands):
    """{path: text} of all files."""
    found = {}
    for program in ("luxel", "luxel-view"):
        found[f"bash/{program}"] = bash(program, commands)
        found[f"zsh/_{program}"] = zsh(program, commands)
        found[f"fish/{program}.fish"] = fish(program, commands)
    return found


def write(folder, commands):
    for path, text in files(commands).items():
        target = folder / path
        target.parent.mkdir(parents=True, exist_ok=True)
        partial = target.with_name(f"{target.name}.partial-{os.getpid()}")  # whole or not at all
        partial.write_text(text, encoding="utf-8")
        partial.replace(target)


COMMANDS = [
    ("luxel", "luxel: light\nUsage: luxel [OPTIONS] SUBCOMMAND\n\nOptions:\n  -h,--help                   Help\n"),
    ("luxel bake", "Bake: it's [light]\nUsage: luxel bake [OPTIONS] [SCENE]\n\nPositionals:\n  SCENE TEXT    A file\n\n"
     "Options:\n  -o,--output TEXT REQUIRED   Folder\n  --uv auto|keep|unwrap=auto  The file's [one]\n"
     "  --device cpu|gpu|gpu:NAME=cpu\n                              What traces\n  --samples RAYS=256          Rays\n"
     "  --solver NAME=gather        How: gather, matrix\n  --settings FILE|none        A file; more\n"
     "  --search-path DIR ...       A folder\n  --html                      A page\n"),
    ("luxel bench", "Tables\nUsage: luxel bench [OPTIONS] NAME\n\nPositionals:\n  NAME TEXT:{all,rays} REQUIRED\n"
     "                              Which\n\nOptions:\n  --quiet                     Nothing\n"),
    ("luxel-view", "Look\nUsage: luxel-view [OPTIONS] [SUBJECT]\n\nPositionals:\n  SUBJECT TEXT  A file\n\n"
     "Options:\n  --relight                   Prepare\n  --device NAME               A part of the name\n"),
]
# What is typed, the last word being completed, and what bash offers in a folder with a.glb, none.txt and folder/.
TYPED = [
    (["luxel", ""], {"bake", "bench", "-h", "--help"}),
    (["luxel", "be"], {"bench"}),
    (["luxel", "bake", "--s"], {"--samples", "--solver", "--settings", "--search-path"}),
    (["luxel", "bake", ""], {"a.glb", "none.txt", "folder"}),
    (["luxel", "bake", "a.glb", "--uv", ""], {"auto", "keep", "unwrap"}),
    (["luxel", "bake", "--uv", "=", "k"], {"keep"}),
    (["luxel", "bake", "--uv", "="], {"auto", "keep", "unwrap"}),
    (["luxel", "bake", "--device", ""], {"cpu", "gpu"}),
    (["luxel", "bake", "--samples", ""], set()),
    (["luxel", "bake", "--solver", "m"], {"matrix"}),
    (["luxel", "bake", "--settings", "no"], {"none", "none.txt"}),
    (["luxel", "bake", "--search-path", ""], {"folder"}),
    (["luxel", "bake", "-o", "f"], {"folder"}),
    (["luxel", "bake", "--html", "a"], {"a.glb"}),
    (["luxel", "bench", "r"], {"rays"}),
    (["luxel", "bench", "--"], {"--quiet"}),
    (["luxel", "fly", "--"], set()),
    (["luxel-view", "--re"], {"--relight"}),
    (["luxel-view", "--uv", ""], {"auto", "keep", "unwrap"}),
    (["luxel-view", "--device", ""], set()),
    (["luxel-view", "a"], {"a.glb"}),
]


def completed_by_bash(file, words, folder):
    """What bash offers for the last of `words`, asked as the shell itself asks."""
    script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
              'function=$(complete -p "$1" | sed "s/.*-F \\([^ ]*\\) .*/\\1/"); $function; '
              'printf "%s\\n" "${COMPREPLY[@]}"')
    run = subprocess.run(["bash", "-euo", "pipefail", "-c", script, "bash", str(file)] + words, cwd=folder,
                         capture_output=True, text=True)
    return (set(run.stdout.split("\n")) - {""}) if run.returncode == 0 else {f"code {run.returncode}: {run.stderr}"}


def wrong_replies(folder):
    for name in ("a.glb", "none.txt"):
        (folder / name).touch()
    (folder / "folder").mkdir()
    for words, wanted in TYPED:
        got = completed_by_bash(folder.parent / "made" / "bash" / words[0], words, folder)
        if got != wanted:
            yield f"{' '.join(words)!r}: {sorted(got)}, expected {sorted(wanted)}"


def wrong_in_fish(folder):
    """fish offers files by itself: what begins with a dash, and choices, are held against bash's."""
    if not shutil.which("fish"):
        return
    for words, wanted in TYPED:
        if "=" in words or not wanted or not (words[-1].startswith("--") or wanted & {"keep", "cpu", "matrix", "bench"}):
            continue
        file = folder / "made" / "fish" / f"{words[0]}.fish"
        run = subprocess.run(["fish", "--no-config", "-c", 'source $argv[1]; complete -C $argv[2]', str(file),
                              " ".join(words)], cwd=folder / "work", capture_output=True, text=True)
        got = {line.split("\t")[0] for line in run.stdout.splitlines()}
        if got != {word for word in wanted if words[-1] or not word.startswith("-")}:
            yield f"fish: {' '.join(words)!r}: {sorted(got)}, expected {sorted(wanted)} {run.stderr}"


def unread_files(folder):
    """What each shell that is installed says against its files."""
    for shell in ("bash", "zsh", "fish"):
        if not shutil.which(shell):
            print(f"self-test: {shell} is not installed, and did not read its files")
            continue
        for file in sorted((folder / shell).iterdir()):
            run = subprocess.run([shell, "-n", str(file)], capture_output=True, text=True)
            if run.returncode != 0 or run.stderr:
                yield f"{shell}: {file.name}: {run.stderr.strip()}"


def self_test():
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        write(folder / "made", [Command(name, text) for name, text in COMMANDS])
        (folder / "work").mkdir()
        faults = list(wrong_replies(folder / "work")) + list(wrong_in_fish(folder))
        faults += list(unread_files(folder / "made"))
    for fault in faults:
        print("self-test:", fault)
    print("make_completions --self-test:", "wrong" if faults else "right")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(run_script(__doc__, self_test, lambda luxel, folder: write(folder, read_all(luxel))))
