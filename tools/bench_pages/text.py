"""Numbers, sentences and tables of the pages."""

import math


def three_digits(value):
    """Three significant digits, without an exponent."""
    if not value > 0:
        return "0"
    before_the_point = math.floor(math.log10(value)) + 1
    return f"{value:.{min(max(3 - before_the_point, 0), 12)}f}"


def grouped(cell):
    """"142 726 748" for "142726748", "~1 234" for "~1234"; other cells as they are."""
    sign = "~" if cell.startswith("~") else ""
    digits = cell[len(sign):]
    return sign + f"{int(digits):,}".replace(",", " ") if digits.isdecimal() else cell


def short_number(value):
    """"12.3 k", "1.5 M"."""
    for limit, factor, unit in ((999_500, 1e6, " M"), (1e4, 1e3, " k")):
        if value >= limit:
            return f"{value / factor:.3g}{unit}"
    return f"{value:g}"


def count(number, one):
    return f"{number} {one}{'' if number == 1 else 's'}"


def enumerated(parts):
    """"a, b and c"."""
    return " and ".join(part for part in (", ".join(parts[:-1]), parts[-1]) if part)


def printable(text):
    """Names come from files: control characters become '?'."""
    return "".join("?" if ord(c) < 0x20 or ord(c) == 0x7F else c for c in text)


def unique(values):
    """Each value once, in the order of its first appearance."""
    return list(dict.fromkeys(values))


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def table(heading, rows, right=()):
    """`right`: the columns that are aligned to the right."""
    rule = "".join("---:|" if i in right else "---|" for i in range(len(heading)))
    lines = ["".join(f"| {cell} " if cell else "| " for cell in row) + "|" for row in (heading, *rows)]
    return "\n".join([lines[0], "|" + rule, *lines[1:]]) + "\n"


def command_block(figures, given, options="", kind="json"):
    """The commands that measure the figures and write the page."""
    if "command" not in figures:
        return ""
    name = given.command
    plots = " --svg FILE.svg" if given.plot else ""
    return (f"<!-- not run -->\n```sh\n{printable(figures['command'])} --{kind} FILE.{kind}\n"
            f"tools/pages {name} FILE.{kind}{options} --markdown FILE.md{plots}\n```\n\n")
