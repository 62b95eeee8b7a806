#!/usr/bin/env python3
"""Counts what makes the sources long or hard to read, and prints one line per count.

usage: readability.py [--check] [--list] [ROOT]
  --check  exit code 1 if a count that has a goal misses the goal
  --list   also print the place of each finding

Counts only files that git tracks.
"""
import argparse
import pathlib
import re
import subprocess
import sys

TOP_LEVEL = ("framegraph", "passes", "shaders", "integration", "configs", "tests", "docs")
CODE = {".cpp", ".hpp", ".h", ".c", ".comp", ".glsl", ".js", ".mjs"}
SCRIPTS = {".sh", ".py", ".cmake"}
HASH_COMMENTS = {".sh", ".py", ".cmake", ".txt", ".yml", ".md5"}
JSON = {".json"}
OPENERS = ("What", "Of", "Who", "Where", "Likewise")
LINE_COLUMNS, TABLE_COLUMNS = 100, 160


def tracked(root):
    names = subprocess.check_output(["git", "-C", root, "ls-files", "-z"], text=True).split("\0")
    return [name for name in names if name and (root / name).is_file()]


def text_of(root, name):
    try:
        return (root / name).read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None  # A binary file has no lines.


def wide_markdown(text):
    """Yields (line number, kind) of lines that are too wide.

    Code blocks, and lines that are wide because of a link, are excepted.
    """
    in_code = False
    link = re.compile(r"\]\([^)]*\)|<https?://[^>]*>|!\[[^\]]*\]")
    for number, line in enumerate(text.splitlines(), 1):
        if re.match(r"\s*(```|~~~)", line):
            in_code = not in_code
        elif in_code or line.startswith("    "):
            continue
        elif line.lstrip().startswith("|"):
            if len(line) > TABLE_COLUMNS:
                yield number, "table"
        elif len(link.sub("]", line)) > LINE_COLUMNS:
            yield number, "prose"


def wide_script(name, text):
    """Yields the numbers of lines that are too wide in a script, a Python or a CMake file.

    Lines that cannot be split are excepted: one word, or wide because of a URL.
    """
    path = pathlib.PurePath(name)
    if not (SCRIPTS.intersection(path.suffixes) or path.name == "CMakeLists.txt"
            or text.startswith("#!")):
        return
    for number, line in enumerate(text.splitlines(), 1):
        if len(re.sub(r"https?://\S+", "", line)) > LINE_COLUMNS and " " in line.strip():
            yield number


def comments(name, text):
    """Yields (line number, text) of the first line of each comment."""
    suffix = pathlib.PurePath(name).suffix
    if suffix in CODE or suffix in JSON:
        start = re.compile(r"(?:^|[\s;{},)])(?://[/!]*<?|/\*+)\s*(.*)")
    elif suffix in HASH_COMMENTS or pathlib.PurePath(name).name == "CMakeLists.txt":
        start = re.compile(r"(?:^|\s)#+\s*(.*)")
    else:
        return
    whole_line = re.compile(r"\s*(//|#|\*)")
    continues = False
    for number, line in enumerate(text.splitlines(), 1):
        found = start.search(line)
        is_whole = bool(whole_line.match(line))
        if found and not (continues and is_whole):
            yield number, found.group(1)
        continues = bool(found) and is_whole


def largest_struct(root, names):
    """Returns (members, name, file) of the largest struct or class below a folder `compile`."""
    end_of_signature = re.compile(r"\)\s*(const)?\s*(noexcept)?\s*(:.*)?$", re.S)
    no_member = re.compile(r"^\s*(using|friend|static|typedef|enum|struct|class|template)\b|"
                           r"\)\s*(const|noexcept|=|$)")
    best = (0, "none", "")
    for name in names:
        if "/compile/" not in name or not name.endswith((".hpp", ".cpp")):
            continue
        text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text_of(root, name) or "", flags=re.S)
        for opening in re.finditer(r"\b(?:struct|class)\s+(\w+)[^;{()]*\{", text):
            depth, members, statement = 1, 0, ""
            for char in text[opening.end():]:
                if char == "{":
                    depth += 1
                elif char == "}":
                    depth -= 1
                    if depth == 0:
                        break
                    if depth == 1 and end_of_signature.search(statement):
                        statement = ""  # The body of a function ends without a semicolon.
                elif depth == 1:
                    if char == ";":
                        is_member = statement.strip() and not no_member.search(
                            re.sub(r"=.*", "", statement, flags=re.S).strip() or "x")
                        members += (statement.count(",") + 1 if is_member and "<" not in statement
                                    and "(" not in statement else bool(is_member))
                        statement = ""
                    else:
                        statement += char
            best = max(best, (members, opening.group(1), name))
    return best


def types_defined_twice(texts):
    """Yields the files of types that have one name in one namespace. Programs with both call the
    functions of either."""
    files = {}
    definition = re.compile(r"(?:template <[^>]*> )?(?:struct|class|enum class) (\w+)(?: final)?"
                            r"(?: : [^;(]*)?(?: \{.*)?$")
    for name, text in texts.items():
        namespaces = []
        for line in (text or "").splitlines() if name.endswith((".cpp", ".hpp")) else ():
            if opening := re.match(r"namespace (?:([\w:]+) )?\{", line):
                namespaces.append(opening.group(1))
            elif line.startswith("} // namespace") and namespaces:
                namespaces.pop()
            elif (found := definition.match(line)) and None not in namespaces:
                files.setdefault(("::".join(namespaces), found.group(1)), set()).add(name)
    for (namespace, kind), places in files.items():
        if len(places) > 1:
            yield f"{namespace}::{kind}: {', '.join(sorted(places))}"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("root", nargs="?", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parent.parent)
    arguments = parser.parse_args()
    root = arguments.root
    names = tracked(root)
    texts = {name: text_of(root, name) for name in names}
    lines = {name: len(text.splitlines()) for name, text in texts.items() if text is not None}

    print(f"files: {len(names)}, lines: {sum(lines.values())}")
    for folder in TOP_LEVEL:
        inside = [name for name in names if name.startswith(folder + "/")]
        print(f"  {folder + '/':<14}{len(inside):>5} files "
              f"{sum(lines.get(name, 0) for name in inside):>7} lines")
    members, struct, file = largest_struct(root, names)
    print(f"members of the largest struct in compile/: {members} ({struct}, {file})")
    print("lines of the public headers: "
          f"{sum(lines[name] for name in names if '/include/dermis/' in name)}")
    documents = [name for name in names if name.endswith(".md")]
    print(f"lines of documents: {sum(lines[name] for name in documents)} in {len(documents)} files")

    findings = {"prose": [], "table": [], "script": [], "opener": [], "issue": [],
                "type": list(types_defined_twice(texts))}
    for name in documents:
        for number, kind in wide_markdown(texts[name]):
            findings[kind].append(f"{name}:{number}")
    opener = re.compile(r"(?:" + "|".join(OPENERS) + r")\b(?! course)")
    for name, text in texts.items():
        if text is None:
            continue
        findings["script"] += [f"{name}:{number}" for number in wide_script(name, text)]
        for number, comment in comments(name, text):
            if opener.match(comment):
                findings["opener"].append(f"{name}:{number}: {comment}")
        for number, line in enumerate(text.splitlines(), 1):
            if re.search(r"\bissue [0-9]", line):
                findings["issue"].append(f"{name}:{number}")
    for kind, title in (("prose", f"Markdown lines over {LINE_COLUMNS} columns "
                                  "outside tables, code and links"),
                        ("table", f"table rows over {TABLE_COLUMNS} columns"),
                        ("script", f"lines over {LINE_COLUMNS} columns "
                                   "in scripts, Python and CMake"),
                        ("opener", "comments that begin with " + ", ".join(OPENERS)),
                        ("issue", "mentions of an issue by number"),
                        ("type", "types defined twice in a namespace")):
        print(f"{title}: {len(findings[kind])} (goal 0)")
        if arguments.list:
            for place in findings[kind]:
                print(f"  {place}")
    return 1 if arguments.check and any(findings.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
