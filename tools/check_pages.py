#!/usr/bin/env python3
"""Checks README.md, ARCHITECTURE.md, CHANGELOG.md and docs/**/*.md.

    tools/check_pages.py [--options FILE] [ROOT]   exit 1 and one line per fault
    tools/check_pages.py --self-test               proves on made-up trees that each kind of fault is found

The rules:
- every relative link and image exists, and so does every #anchor of a heading;
- no line is longer than 120 characters, outside tables, code blocks, and lines that hold nothing but links and
  images or one word;
- in README.md and docs/guide/ no sentence has more than 35 words, outside tables and code;
- every --option in backticks, or in a command of a code block that starts with luxel, is a line of FILE (one name per
  line, with or without --; without FILE this is skipped);
- every `luxel COMMAND` in backticks or in a code block is a command of luxel;
- commands of code blocks write to no file or folder that the checkout has, other than baked/ and build/: by options for
  output, by >, as targets of cp, mv and tee, or as arguments of tools that make files.
"""
import pathlib
import re
import sys
import tempfile
import urllib.parse

COMMANDS = {"info", "bake", "merge", "render", "compare", "factors", "relight", "probe", "lux", "bench", "doctor"}
ALWAYS = {"help", "version"}
MOST_CHARACTERS, MOST_WORDS = 120, 35
IGNORED = {"baked", "build"}  # by git

FENCE = re.compile(r"\s*(```+|~~~+)")
ITEM = re.compile(r"^\s*([-*+]|\d{1,2}[.)])\s+")
HEADING = re.compile(r"(#{1,6})\s+(.*?)\s*#*\s*$")
SPAN = re.compile(r"(`+)(.+?)\1")
LINK = re.compile(r"!?\[((?:[^\[\]]|\[[^\[\]]*\])*)\]\(\s*<?([^)\s>]*)>?(?:\s+\"[^\"]*\")?\s*\)")
LINKED_IMAGE = re.compile(r"\[!\[[^\]]*\]\(([^)\s]*)\)\]\(([^)\s]*)\)")
REFERENCE = re.compile(r"^\s{0,3}\[[^\]]+\]:\s+<?(\S+?)>?\s*$")
HTML = re.compile(r"<(?:img|a|source)\b[^>]*?\b(?:src|href)\s*=\s*[\"']([^\"']*)[\"']", re.IGNORECASE)
OPTION = re.compile(r"(?<![\w-])--([a-z][a-z0-9-]*)")
PROGRAM = re.compile(r"(?:[^\s`]*/)?luxel(?=\s|$)")
COMMAND = re.compile(r"(?:^|[\s;|&(])(?:[^\s`]*/)?luxel\s+([a-z][a-z-]*)(?=[\s.,;:)|&]|$)")
WRITTEN = re.compile(r"(?<=\s)(?:(?:-o|--output|--report|--screenshot|--frame-times)(?:\s+|=)|\d?>>?\s*)(\S+)")
COPIES = re.compile(r"\s*(?:cp|mv|tee)\s.*?(\S+)\s*$")
MAKES = re.compile(r"(?:^|.*\s)\S*(?:lightmap_png\.py|luxel_draw_skies|blender_addon\.sh)\s+(.*)")


class Line:
    """A line of a page: `kind` is prose, table, code, heading or blank."""

    def __init__(self, number, text, kind):
        self.number, self.text, self.kind = number, text, kind


def lines_of(text):
    """Markdown's blocks, as far as these pages use them."""
    out, fence, list_indent, previous = [], None, None, "blank"
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.expandtabs(4)
        indent = len(line) - len(line.lstrip())
        mark = FENCE.match(line)
        if fence:
            kind = "code"
            if mark and mark.group(1).startswith(fence) and not line.strip(" `~"):
                fence = None
        elif mark:
            fence, kind = mark.group(1), "code"
        elif not line.strip():
            kind = "blank"
        # Within a list code is indented by four more than the item's text.
        elif indent >= (list_indent or 0) + 4 and previous in ("blank", "code", "heading"):
            kind = "code"
        else:
            item = ITEM.match(line)
            if item:
                list_indent = len(item.group(0))
            elif indent == 0 and previous in ("blank", "code", "table", "heading"):
                list_indent = None
            kind = ("heading" if HEADING.match(line) else
                    "table" if line.lstrip().startswith("|") else "prose")
        if kind != "blank" or previous != "code":  # a blank line within code ends nothing
            previous = kind
        out.append(Line(number, raw, kind))
    return out


def without_spans(text, instead="code"):
    return SPAN.sub(instead, text)


def slug(title):
    """The anchor that GitHub gives to a heading."""
    title = LINK.sub(lambda m: m.group(1), title).replace("`", "").replace("*", "")
    return re.sub(r"[^\w\- ]", "", title.strip().lower()).replace(" ", "-")


def anchors_of(text):
    found = set()
    for line in lines_of(text):
        if line.kind == "heading":
            name, n = slug(HEADING.match(line.text).group(2)), 0
            while f"{name}-{n}" in found if n else name in found:
                n += 1
            found.add(f"{name}-{n}" if n else name)
        elif line.kind != "code":
            found |= set(re.findall(r"<a\s+(?:id|name)=[\"']([^\"']+)", line.text))
    return found


def targets(line):
    if line.kind == "code":
        return
    text = without_spans(line.text)
    for match in LINKED_IMAGE.finditer(text):
        yield from match.groups()
    text = LINKED_IMAGE.sub("", text)
    for pattern, group in ((LINK, 2), (REFERENCE, 1), (HTML, 1)):
        for match in pattern.finditer(text):
            yield match.group(group)


def link_faults(root, path, lines, anchors):
    for line in lines:
        for target in targets(line):
            if re.match(r"[a-zA-Z][a-zA-Z0-9+.-]*:", target):  # https:, mailto:
                continue
            name, _, anchor = urllib.parse.unquote(target).partition("#")
            file = (root / path).parent / name if name else root / path
            if name.startswith("/") or not file.exists():
                yield f"{path}:{line.number}: {target}: there is no such file"
            elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                yield f"{path}:{line.number}: {target}: there is no such heading"


def unbreakable(text):
    """Nothing but links, images and what stands around them; or a single word."""
    rest = HTML.sub("", LINK.sub("", LINKED_IMAGE.sub("", ITEM.sub("", text, count=1))))
    rest = re.sub(r"<[^>]*>", "", rest) if "<" in text else rest
    return not re.search(r"\w", rest) or len(ITEM.sub("", text, count=1).split()) == 1


def width_faults(path, lines):
    for line in lines:
        if line.kind not in ("table", "code") and len(line.text) > MOST_CHARACTERS and not unbreakable(line.text):
            yield f"{path}:{line.number}: {len(line.text)} characters; wrap at {MOST_CHARACTERS}"


def paragraphs(lines):
    """(line numbers of the words, words) of each paragraph, item and heading."""
    block = []
    for line in lines + [Line(0, "", "blank")]:
        starts = line.kind != "prose" or ITEM.match(line.text)
        if starts and block:
            yield block
            block = []
        if line.kind in ("prose", "heading"):
            text = re.sub(r"^\s*>\s?", "", ITEM.sub("", line.text, count=1) if line.kind == "prose"
                          else line.text.lstrip("# "))
            block.append((line.number, text))
        if line.kind == "heading":
            yield block
            block = []


def sentence_faults(path, lines):
    for block in paragraphs(lines):
        # Links can go over the end of a line, so they are taken out of the whole; \0n\0 marks lines.
        text = " ".join(f"\0{number}\0 {text}" for number, text in block)
        text = without_spans(text, "code")
        text = re.sub(r"!\[[^\]]*\]\([^)]*\)", " ", text)
        text = LINK.sub(lambda m: m.group(1), text)
        text = re.sub(r"<[^>]*>", " ", text).replace("*", "")
        number = start = block[0][0]
        words = 0
        for token in text.split() + ["."]:
            mark = re.fullmatch("\0(\\d+)\0", token)
            if mark:
                number = int(mark.group(1))
                continue
            if not words:
                start = number
            words += bool(re.search(r"\w", token))
            if re.search(r"[.!?][\"')\]]*$", token):
                if words > MOST_WORDS:
                    yield f"{path}:{start}: a sentence of {words} words; {MOST_WORDS} at most"
                words = 0


def commands_of(lines):
    """(line number, text) of what is code: spans in backticks, and lines of code blocks with continuations joined."""
    joined = None
    for line in lines:
        if line.kind != "code":
            joined = None
            for match in SPAN.finditer(line.text):
                yield line.number, match.group(2).strip(), True
            continue
        text = line.text.strip()
        ends = text.endswith("\\")
        joined = (joined[0], joined[1] + " " + text.rstrip("\\")) if joined else (line.number, text.rstrip("\\"))
        if not ends:
            yield joined[0], joined[1], False
            joined = None


def command_faults(path, lines, options):
    for number, text, span in commands_of(lines):
        text = re.sub(r"(^|\s)#\s.*$", "", text)  # a comment of the shell
        starts = re.match(r"(\$ )?" + PROGRAM.pattern, text)
        if starts or span:
            for name in COMMAND.findall(text):
                if name not in COMMANDS:
                    yield f"{path}:{number}: luxel {name}: there is no such command"
        # In backticks: the option alone, or with luxel or one of its commands before it.
        ours = starts or span and (text.startswith("--") or text.split()[0] in COMMANDS or PROGRAM.search(text))
        if options is None or not ours:
            continue
        for name in OPTION.findall(text):
            if name not in options:
                yield f"{path}:{number}: --{name}: there is no such option"


def written_by(text):
    """The paths that a command writes to, as far as its line tells."""
    for part in re.split(r"[;|&]+", text):
        yield from WRITTEN.findall(part)
        yield from COPIES.findall(part)
        for arguments in MAKES.findall(part):
            yield from arguments.split()


def output_faults(root, path, lines):
    for number, text, span in commands_of(lines):
        for file in () if span else written_by(re.sub(r"(^|\s)#\s.*$", "", text)):
            first = (*pathlib.PurePosixPath(file.strip("'\"")).parts, ".")[0]
            if not file.startswith("/") and first not in IGNORED and (root / first).exists():
                yield f"{path}:{number}: {file}: commands of pages write below baked/"


def pages(root):
    named = [root / name for name in ("README.md", "ARCHITECTURE.md", "CHANGELOG.md")]
    return [file for file in named if file.exists()] + sorted((root / "docs").rglob("*.md"))


def faults(root, options=None):
    known = {}

    def anchors(file):
        file = file.resolve()
        if file not in known:
            known[file] = anchors_of(file.read_text())
        return known[file]

    for file in pages(root):
        path = file.relative_to(root).as_posix()
        lines = lines_of(file.read_text())
        yield from link_faults(root, path, lines, anchors)
        yield from width_faults(path, lines)
        if path == "README.md" or path.startswith("docs/guide/"):
            yield from sentence_faults(path, lines)
        yield from command_faults(path, lines, options)
        yield from output_faults(root, path, lines)


def read_options(file):
    names = (line.strip().lstrip("-") for line in pathlib.Path(file).read_text().splitlines())
    return {name for name in names if name} | ALWAYS


LONG = "word " * 30
GOOD = {
    "README.md": f"""# luxel
luxel computes light. See [the guide](docs/guide/a.md#of-lights-and-luxel-bake) and ![a picture](docs/images/a.png).

    build/release/bin/luxel bake scenes/a.glb -o out \\
      --good 3    # luxel fly is a comment
    other --bad "{LONG}{LONG}"

```
luxel bench rays -o x
cp docs/images/a.png baked/a.png; tools/lightmap_png.py baked/a.glb baked/a.png > baked/log  # tee docs
{LONG}{LONG}
```

| `--good` | {LONG}{LONG}{LONG} |
|---|---|

- {"ten words stand here, nine and one full stop now. " * 2}
- An item of a list, [here](#luxel), goes on
  in its second line.

![{LONG}](docs/images/a.png) ![{LONG}](docs/images/a.png)
`cmake --preset release` and `luxel bake --good 3` and `bake --good` and `luxel` alone; `luxel records2`,
[twice](docs/guide/a.md#twice-1).
""",
    "docs/guide/a.md": "## Of lights, and `luxel bake`\n\n# Twice\n# Twice\n\n[up](../../README.md)\n"
                       "[mail](mailto:a@b.c) [web](https://example.org/none#x) `[no](link.md)`\n\n"
                       "Twenty words and more stand in a sentence that ends here, as everybody can see, "
                       "with 1024 x 1024 x 1024. And then\nanother one, which has a few words of its own, and ends soon after that, too.\n",
    "docs/method/m.md": f"# Method\n\n{(LONG[:100] + chr(10)) * 3}\n",  # long sentences are allowed here
    "docs/images/a.png": "",
    "elsewhere.md": "[none](none.md)\n",
}
GOOD_OPTIONS = {"good"} | ALWAYS
# Each is added at the end of a page of the good tree and makes exactly one fault, whose line contains the text.
BAD = [
    ("README.md", "[a](docs/none.md)", "docs/none.md: there is no such file"),
    ("README.md", "[![a](docs/images/none.png)](docs/guide/a.md)", "none.png: there is no such file"),
    ("README.md", "<img src=\"docs/images/b.png\" width=\"9\">", "b.png: there is no such file"),
    ("README.md", "| [a](docs/none.md) |", "docs/none.md: there is no such file"),
    ("docs/guide/a.md", "[a]: none.txt", "none.txt: there is no such file"),
    ("docs/guide/a.md", "[a](/docs/guide/a.md)", "there is no such file"),
    ("docs/method/m.md", "![a](../images/none.svg)", "docs/method/m.md:8: ../images/none.svg: there is no such file"),
    ("docs/method/m.md", "[a](#methods)", "#methods: there is no such heading"),
    ("docs/method/m.md", "[a](../guide/a.md#twice-2)", "#twice-2: there is no such heading"),
    ("docs/method/m.md", LONG, "150 characters"),
    ("docs/method/m.md", "# " + LONG, "characters"),
    ("docs/method/m.md", "[a](m.md) " + LONG, "characters"),
    ("docs/method/m.md", "- an item\n\n  " + LONG, "m.md:10: 152 characters"),
    ("CHANGELOG.md", LONG, "CHANGELOG.md:2: 150 characters"),
    ("docs/guide/a.md", "a b c d e f g h i j k l m\n" * 3, "a sentence of 39 words"),
    ("README.md", "- " + "a b c d e f g h i `j k` l m\n  " * 3, "a sentence of 36 words"),
    ("README.md", "One. " + "a b c d e f g h i j k l m\n" * 3 + "n. Two.", "a sentence of 40 words"),
    ("README.md", "`--bad`", "--bad: there is no such option"),
    ("README.md", "| `--bad N\\|auto` |", "--bad: there is no such option"),
    ("docs/method/m.md", "`luxel render --bad`", "--bad: there is no such option"),
    ("docs/method/m.md", "`relight --bad`", "--bad: there is no such option"),
    ("docs/method/m.md", "    luxel bake a \\\n      --bad", "m.md:8: --bad: there is no such option"),
    ("docs/method/m.md", "```sh\nx/luxel bake a --bad\n```", "m.md:9: --bad: there is no such option"),
    ("docs/method/m.md", "`luxel fly`", "luxel fly: there is no such command"),
    ("docs/method/m.md", "    build/release/bin/luxel fly a", "luxel fly: there is no such command"),
    ("README.md", "    luxel bake a \\\n      -o docs/b.png", "docs/b.png: commands of pages write below baked/"),
    ("README.md", "    luxel-view a --screenshot=./docs/$a.png; done", "./docs/$a.png: commands"),
    ("README.md", "    luxel bake a -o .", "README.md:25: .: commands"),
    ("README.md", "    x --csv 2> docs/a.csv", "docs/a.csv: commands"),
    ("README.md", "    mv baked/a.png baked/b.png 'docs/images'", "'docs/images': commands"),
    ("README.md", "    for a in 1 2; do tools/lightmap_png.py baked/a.glb docs/a.png $a; done", "docs/a.png: comm"),
]


def write_tree(root, files):
    for path, text in files.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(text)


def self_test():
    wrong = 0
    for path, text, expected in [(None, None, None)] + BAD:
        files = dict(GOOD)
        if path:
            files[path] = files.get(path, "") + "\n" + text + "\n"
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            write_tree(root, files)
            found = list(faults(root, GOOD_OPTIONS))
        right = not found if path is None else len(found) == 1 and expected in found[0]
        wrong += not right
        if not right:
            print(f"self-test: {path}: {text!r}: expected {expected}, found {found}")
    print(f"check_pages --self-test: {len(BAD) + 1 - wrong} of {len(BAD) + 1} right")
    return wrong


def main():
    arguments = sys.argv[1:]
    if arguments == ["--self-test"]:
        return 1 if self_test() else 0
    options = None
    if "--options" in arguments:
        at = arguments.index("--options")
        if at + 1 == len(arguments):
            print("check_pages: --options needs a FILE", file=sys.stderr)
            return 2
        options = read_options(arguments[at + 1])
        del arguments[at:at + 2]
    if len(arguments) > 1 or arguments and arguments[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    default = pathlib.Path(__file__).resolve().parent.parent
    found = list(faults(pathlib.Path(arguments[0]) if arguments else default, options))
    for fault in found:
        print(fault)
    print(f"check_pages: {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
