"""Relative links of Markdown pages that lead nowhere: a file that is not there, or a heading that it has not.

doc_links.py PAGE... prints one line for each, and ends with 1 where there is one."""
import os, re, sys


def prose(text):
    """The page without code, whose brackets are no links."""
    text = re.sub(r"^(```|~~~).*?^\1", "", text, flags=re.M | re.S)
    lines, before = [], ""
    for line in text.split("\n"):
        if not (line.startswith("    ") and before.strip() == ""):
            lines.append(re.sub(r"`[^`]*`", lambda m: "x" * len(m[0]), line))
            before = line
    return "\n".join(lines)


def anchors(path):
    """What GitHub makes of the headings: lower case, no punctuation, blanks to dashes, repeated ones numbered."""
    seen, names = {}, set()
    text = re.sub(r"^(```|~~~).*?^\1", "", open(path, encoding="utf-8").read(), flags=re.M | re.S)
    for heading in re.findall(r"^#{1,6} +(.*?) *#*$", text, flags=re.M):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        count = seen[name] = seen.get(name, -1) + 1
        names.add(name + ("-%d" % count if count else ""))
    return names


bad, links = 0, 0
for page in sys.argv[1:]:
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(open(page, encoding="utf-8").read())):
        if re.match(r"[a-z]+:", target):
            continue
        links += 1
        file, _, anchor = target.partition("#")
        path = os.path.normpath(os.path.join(os.path.dirname(page), file)) if file else page
        if not os.path.exists(path):
            why = "no such file"
        elif anchor and path.endswith(".md") and anchor not in anchors(path):
            why = "no such heading"
        else:
            continue
        print("%s: %s: %s" % (os.path.basename(page), target, why))
        bad += 1
sys.exit(bad > 0 or links < 20)
