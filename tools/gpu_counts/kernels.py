"""Parses nvcc's resource usage of kernels, and prints it in a table with the counts from nvdisasm."""
import collections
import json
import pathlib
import re
import shlex

import sass

Resources = collections.namedtuple("Resources", "registers stack spills spills_called")
Row = collections.namedtuple("Row", "kernel architecture resources instructions turn")

_ENTRY = re.compile(r"Compiling entry function '(\S+)' for")
_PROPERTIES = re.compile(r"Function properties for (\S+)")
_STACK = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")
_REGISTERS = re.compile(r"Used (\d+) registers(?:.*?(\d+) bytes cumulative stack size)?")


def cuda_commands(text):
    """{source: arguments} of the library's CUDA sources in a compile_commands.json."""
    found = {}
    for entry in json.loads(text):
        source = pathlib.Path(entry["file"])
        if source.suffix == ".cu" and "src" in source.parts and "tests" not in source.parts:
            found[source.resolve()] = shlex.split(entry["command"])
    return found


def cubin_command(arguments, architecture, cubin, uses):
    """The same compilation, but to machine code of one architecture."""
    command, skip = [], False
    for argument in arguments:
        if skip or argument in ("-c", "-MD") or argument.startswith("--generate-code"):
            skip = False
            continue
        if argument in ("-o", "-MT", "-MF"):
            skip = True
            continue
        command.append(argument)
    return command + ["-cubin", f"-arch=sm_{architecture}", "-Xptxas", "-v", "-MD", "-MF", str(uses), "-o",
                      str(cubin)]


def is_fresh(cubin, log, uses, stamp):
    """Whether a cubin is what this command would make of the current sources."""
    if not (cubin.exists() and log.exists() and uses.exists() and log.read_text().startswith(stamp)):
        return False
    made = cubin.stat().st_mtime
    sources = uses.read_text().replace("\\\n", " ").split(":", 1)[1].split()
    return all(pathlib.Path(s).exists() and pathlib.Path(s).stat().st_mtime <= made for s in sources)


def resources_of(log):
    """{mangled kernel: Resources} from the output of `ptxas -v`.

    It lists a kernel's own properties, its registers, and then the properties of each function that
    the
    kernel calls and that is not inlined.
    """
    found, entry, function = {}, None, None
    for line in log.splitlines():
        if match := _ENTRY.search(line):
            entry = match[1]
            found[entry] = Resources(0, 0, 0, 0)
        elif match := _PROPERTIES.search(line):
            function = match[1]
        elif (match := _STACK.search(line)) and entry:
            stack, *spills = map(int, match.groups())
            old = found[entry]
            if function == entry:
                found[entry] = old._replace(stack=stack, spills=sum(spills))
            else:
                found[entry] = old._replace(spills_called=old.spills_called + sum(spills))
        elif (match := _REGISTERS.search(line)) and entry:
            stack = max(found[entry].stack, int(match[2] or 0))
            found[entry] = found[entry]._replace(registers=int(match[1]), stack=stack)
    return found


def short_name(demangled):
    """"void raysheaf::run_items<raysheaf::A<T>::b<U>(...)::{lambda(unsigned long)#2}>(...)" is "A::b 2"."""
    inner = demangled.split("run_items<", 1)
    if len(inner) == 1:
        return _without_templates(demangled.split("(", 1)[0]).split()[-1].replace("raysheaf::", "")
    number = re.search(r"#(\d+)\}", inner[1])
    name = _without_templates(inner[1]).split("(", 1)[0].replace("raysheaf::", "")
    return name if number is None or number[1] == "1" else f"{name} {number[1]}"


def _without_templates(text):
    """The text up to the first argument list, without the parts in angle brackets."""
    kept, depth = "", 0
    for letter in text:
        if letter == "<":
            depth += 1
        elif letter == ">":
            depth -= 1
        elif depth == 0:
            if letter == "(":
                break
            kept += letter
    return kept


def rows(architecture, resources, listing, demangled):
    """A Row for each kernel."""
    functions = sass.functions(listing)
    found = []
    for name, used in resources.items():
        instructions, labels = functions[name]
        way = sass.inner_turn(sass.blocks_of(instructions, labels))
        real = [i for i in instructions if i.opcode != "NOP"]
        found.append(Row(short_name(demangled[name]), architecture, used, len(real), way and sass.count(way)))
    return found


def table(all_rows):
    """A Markdown table: kernels by name, architectures ascending.

    Several sources may have the same kernel.
    """
    text = ["| Kernel | sm | Registers | Stack, bytes | Spills, bytes | Spills of called functions "
            "| Instructions | Turn | Global loads | Bytes of these | Local accesses | Memory instructions |",
            "|---|" + "--:|" * 11]
    for row in sorted(all_rows, key=lambda r: (r.kernel, int(re.sub(r"\D", "", r.architecture)), str(r))):
        turn = row.turn or ("–",) * len(sass.Turn._fields)
        cells = [f"`{row.kernel}`", row.architecture, *row.resources, row.instructions, *turn]
        line = "| " + " | ".join(map(str, cells)) + " |"
        if line != text[-1]:
            text.append(line)
    return "\n".join(text) + "\n"
