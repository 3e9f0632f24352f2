#!/usr/bin/env python3
"""Prints which crates call the mathematics of the C library in a program: `FUNCTION CRATE`, in order.

    tests/numbers/calls.py PROGRAM

It reads what `objdump` prints, so the program must have the names of its functions. Python 3.11, no packages.
"""

import re
import subprocess
import sys

FUNCTIONS = {
    name + end
    for name in "sin cos tan sincos asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp exp2 exp10 expm1 log log2 log10 log1p pow cbrt "
    "hypot fma tgamma lgamma lgamma_r erf erfc".split()
    for end in ("", "f")
}
FUNCTION = re.compile(r"^[0-9a-f]+ <(.*)>:$")
# A call through the table of addresses, or directly: a comment or the operand names the target.
TARGET = re.compile(r"<(\w+)@(?:plt|GLIBC|Base)")


def calls(program: str) -> set[tuple[str, str]]:
    """The functions that are called, and the crates that call them."""
    found, caller = set(), ""
    with subprocess.Popen(
        ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", program], stdout=subprocess.PIPE, text=True
    ) as listing:
        for line in listing.stdout:
            if match := FUNCTION.match(line):
                caller = re.match(r"[<&]*(\w*)", match[1])[1]
            elif (match := TARGET.search(line)) and match[1] in FUNCTIONS:
                found.add((match[1], caller))
    if listing.returncode != 0:
        raise SystemExit(f"objdump cannot read {program}")
    return found


def imported(program: str) -> set[str]:
    """The functions of the C library's mathematics that the program names."""
    symbols = subprocess.run(["objdump", "--dynamic-syms", program], check=True, stdout=subprocess.PIPE, text=True).stdout
    return FUNCTIONS & {line.split()[-1] for line in symbols.splitlines() if "*UND*" in line}


def main() -> int:
    program = sys.argv[1]
    found = calls(program)
    # What is named but called by nobody is called in a way that this script does not see.
    unseen = imported(program) - {function for function, _ in found}
    found |= {(function, "?") for function in unseen}
    for function, caller in sorted(found):
        print(function, caller)
    return 0


if __name__ == "__main__":
    sys.exit(main())
