"""Parses the output of nvdisasm: a kernel's instructions, and the shortest turn of its inner loop.

  block ─► block ─► block ─► ...      a block ends where a branch begins or arrives
  ▲                 │
  └─────────────────┘               a turn: a path from a block back to itself

The inner loop is found by its memory accesses: among the blocks that lie on a cycle, it has the
block that reads most bytes of global memory from one address. Among all turns through that block,
the one with the fewest instructions counts. It is found by Dijkstra's algorithm over blocks and
known
values of predicates: a branch tells the values of its own predicates, and the compiler sets some to
constants, so that no path contradicts them. A call counts as one instruction, and so does a
predicated instruction, because the warp issues it.
"""
import collections
import heapq
import itertools
import re

_FUNCTION = re.compile(r"^\.text\.(\S+):$")
_LABEL = re.compile(r"^(\S+):$")
_INSTRUCTION = re.compile(r"^\s+/\*([0-9a-f]+)\*/\s+(?:@(!?U?P\w+)\s+)?([A-Z][\w.]*)\s*([^;]*);")
_TARGET = re.compile(r"`\(([^)]*)\)")
_ADDRESS = re.compile(r"(?<!desc)\[(R\d+)[^]]*\]")
_PREDICATE = re.compile(r"!?\bU?P\d\b")
_CONSTANT = re.compile(r"(U?P\d), U?PT, U?PT, U?PT, U?PT, (0x[0-9a-f]+)")
_LOADS = {"LDG", "LD"}
_MEMORY = {"LDG", "LD", "LDL", "LDS", "STG", "ST", "STL", "STS", "ATOM", "ATOMG", "ATOMS", "RED", "REDG"}
_MOST_STATES = 200000  # examined for one turn
_ENDS = {"EXIT", "RET", "BRX", "JMX", "KILL", "BPT"}

Block = collections.namedtuple("Block", "instructions next")
Turn = collections.namedtuple("Turn", "instructions global_loads global_bytes local_memory memory")


class Instruction:
    """One line of a function."""

    def __init__(self, guard, code, operands):
        self.opcode, *self.modifiers = code.split(".")
        self.operands = operands.split("(*")[0].strip()
        target = _TARGET.search(operands)
        # The compiler also uses CALL for labels within a function, from which no call returns.
        self.is_branch = self.opcode in ("BRA", "JMP") or (
            self.opcode == "CALL" and target is not None and target.group(1).startswith(".L"))
        self.target = target.group(1) if target and self.is_branch else None
        self.conditions = [guard] if guard else []
        if self.is_branch:
            self.conditions += _PREDICATE.findall(self.operands.split("`")[0])
        self.conditions = [c for c in self.conditions if not c.endswith("PT")]

    def ends_block(self):
        return self.is_branch or self.opcode in _ENDS

    def goes_on(self):
        """Whether the next instruction may follow."""
        return not self.ends_block() or bool(self.conditions)

    def bytes(self):
        """The bytes that it moves per thread."""
        for modifier in self.modifiers:
            if modifier in ("U8", "S8"):
                return 1
            if modifier in ("U16", "S16"):
                return 2
            if modifier in ("64", "128", "256"):
                return int(modifier) // 8
        return 4

    def base(self):
        """The register at the start of a load's address; None without one."""
        address = _ADDRESS.search(self.operands)
        return address.group(1) if address else None

    def tell(self, known):
        """Updates {predicate: value} to what is known after the instruction.

        A predicate that the instruction names becomes unknown, even if it was only read.
        """
        if self.ends_block():
            return
        if self.opcode in ("CALL", "R2P", "R2UP"):
            known.clear()
        for predicate in _PREDICATE.findall(self.operands):
            known.pop(predicate.lstrip("!"), None)
        constant = _CONSTANT.match(self.operands) if self.opcode in ("PLOP3", "UPLOP3") else None
        if constant and not self.conditions:
            # A lookup table of three predicates that are all true: its last bit.
            known[constant.group(1)] = bool(int(constant.group(2), 16) & 0x80)


def functions(text):
    """{name: (instructions, {label: place})} from a listing by `nvdisasm -c`."""
    found, instructions, labels = {}, None, None
    for line in text.splitlines():
        function = _FUNCTION.match(line)
        if function:
            instructions, labels = [], {}
            found[function.group(1)] = (instructions, labels)
            continue
        if instructions is None:
            continue
        if line.startswith("\t.section"):
            instructions = None
            continue
        label = _LABEL.match(line)
        if label:
            labels[label.group(1)] = len(instructions)
            continue
        match = _INSTRUCTION.match(line)
        if match:
            instructions.append(Instruction(*match.groups()[1:]))
    return found


def blocks_of(instructions, labels):
    """Basic blocks in order; `next` has (number, whether by a branch) of their successors."""
    starts = {0}
    for place, instruction in enumerate(instructions):
        if instruction.ends_block():
            starts.add(place + 1)
        if instruction.target in labels:
            starts.add(labels[instruction.target])
    starts = sorted(s for s in starts if s < len(instructions))
    number = {start: i for i, start in enumerate(starts)}
    blocks = []
    for i, start in enumerate(starts):
        end = starts[i + 1] if i + 1 < len(starts) else len(instructions)
        last, after = instructions[end - 1], []
        if last.target in labels and labels[last.target] in number:
            after.append((number[labels[last.target]], True))
        if last.goes_on() and end in number:
            after.append((number[end], False))
        blocks.append(Block(instructions[start:end], after))
    return blocks


def _values(conditions, taken):
    """{predicate: value} if a branch with these conditions is taken, or is not taken."""
    if not taken and len(conditions) > 1:
        return {}
    return {c.lstrip("!"): c.startswith("!") != taken for c in conditions}


def _ways_on(blocks, block, known):
    """(next block, known values there) for the paths that agree with what is known."""
    known = dict(known)
    for instruction in blocks[block].instructions:
        instruction.tell(known)
    last = blocks[block].instructions[-1]
    for after, taken in blocks[block].next:
        told = _values(last.conditions, taken) if last.ends_block() else {}
        if all(known.get(predicate, value) == value for predicate, value in told.items()):
            yield after, frozenset({**known, **told}.items())


def shortest_turn(blocks, through):
    """The blocks of the turn with the fewest instructions through one block; None if there is no
    turn."""
    before, order = {}, itertools.count()
    heap = [(0, next(order), through, frozenset(), None)]
    while heap:
        cost, _, block, known, previous = heapq.heappop(heap)
        if (block, known) in before:
            continue
        if block == through and previous is not None:
            way = []
            while previous is not None:
                way.append(previous[0])
                previous = before[previous]
            return way[::-1]
        before[block, known] = previous
        if len(before) > _MOST_STATES:
            return None
        cost += len(blocks[block].instructions)
        for after, then in _ways_on(blocks, block, known):
            heapq.heappush(heap, (cost, next(order), after, then, (block, known)))
    return None


def _most_from_one_base(block):
    """(bytes, loads) of a block's global loads with one address register."""
    sums = collections.defaultdict(lambda: [0, 0])
    for instruction in block.instructions:
        if instruction.opcode in _LOADS:
            group = sums[instruction.base()]
            group[0] += instruction.bytes()
            group[1] += 1
    return tuple(max(sums.values(), default=(0, 0)))


def inner_turn(blocks):
    """The turn of the inner loop, or None if no loop reads global memory.

    Among blocks that read the same number of bytes by the same number of loads, it is the one with
    the
    longest turn.
    """
    most, longest = (0, 0), None
    for reads, place in sorted(((_most_from_one_base(b), i) for i, b in enumerate(blocks)), reverse=True):
        if reads < most or reads == (0, 0):
            break
        way = shortest_turn(blocks, place)
        if way is None:
            continue
        most = reads
        turn = [instruction for block in way for instruction in blocks[block].instructions]
        if longest is None or len(turn) > len(longest):
            longest = turn
    return longest


def count(instructions):
    """The counts of a turn."""
    loads = [i for i in instructions if i.opcode in _LOADS]
    return Turn(len(instructions), len(loads), sum(i.bytes() for i in loads),
                sum(i.opcode in ("LDL", "STL") for i in instructions),
                sum(i.opcode in _MEMORY for i in instructions))
