"""Which names the headers of C, C++ and POSIX take, as the compiler says: makes ``taken.txt``.

    python -m liegen.names.collect > src/liegen/names/taken.txt

The file is checked in; it is made anew where a newer compiler or C library defines more. Names that begin
with an underscore are left out: no name of a factor does.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable
from textwrap import fill

C = """assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign
stdarg stdatomic stdbit stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time
uchar wchar wctype"""
#: Those of POSIX beyond C, as its table of headers names them: what they declare must not be defined anew.
POSIX = """aio arpa/inet cpio dirent dlfcn fcntl fmtmsg fnmatch ftw glob grp iconv langinfo libgen mqueue
monetary net/if netdb netinet/in netinet/tcp nl_types poll pthread pwd regex sched search semaphore spawn
strings sys/ipc sys/mman sys/msg sys/resource sys/select sys/sem sys/shm sys/socket sys/stat sys/statvfs
sys/time sys/times sys/types sys/uio sys/un sys/utsname sys/wait syslog tar termios ulimit unistd utime utmpx
wordexp"""
CPP = """algorithm array cassert cfloat climits cmath complex cstdint cstdio cstdlib cstring functional
iostream memory string vector"""
C_MODES = ("gnu17", "c99", "c11", "c17", "c2x", "gnu2x")
CPP_MODES = ("gnu++17", "c++11", "gnu++20")


def preprocessed(header: str, compiler: str, mode: str, *flags: str) -> str:
    """What the preprocessor makes of a header; nothing where the mode does not have it."""
    command = [compiler, f"-std={mode}", "-E", *flags, "-"]
    done = subprocess.run(command, input=header, capture_output=True, text=True, check=False, timeout=60)
    return done.stdout if done.returncode == 0 else ""


def included(names: str, suffix: str) -> list[str]:
    """A line for each header."""
    return [f"#include <{name}{suffix}>\n" for name in names.split()]


def macros(headers: Iterable[str], compiler: str, modes: Iterable[str]) -> set[str]:
    """The macros that each header, alone, defines in any of the modes, and those of the compiler itself."""
    texts = [preprocessed(h, compiler, mode, "-dM") for mode in modes for h in headers]
    return {name for text in texts for name in re.findall(r"^#define ([A-Za-z]\w*)", text, re.MULTILINE)}


def declared(headers: Iterable[str]) -> set[str]:
    """The identifiers that the headers use, those with an underscore: names of functions, types and more."""
    text = "".join(preprocessed(h, "gcc", "gnu17", "-P") for h in headers)
    return {name for name in re.findall(r"\b[A-Za-z]\w*\b", text) if "_" in name}


def main() -> None:
    """Print the file."""
    c, posix, cpp = included(C, ".h"), included(POSIX, ".h"), included(CPP, "")
    of_c = macros(c, "gcc", C_MODES)
    of_cpp = macros(cpp, "g++", CPP_MODES) - of_c
    version = subprocess.run(["gcc", "--version"], capture_output=True, text=True, check=True).stdout
    print(f"# Made by python -m liegen.names.collect with {version.splitlines()[0]}; not to be edited.")
    for title, source, names in (
        ("macros of C", f"{' '.join(C.split())}; -std={' '.join(C_MODES)}", of_c),
        ("macros of C++", f"{' '.join(CPP.split())}; -std={' '.join(CPP_MODES)}", of_cpp),
        ("declarations", f"those of C, and {' '.join(POSIX.split())}", declared([*c, *posix])),
    ):
        print(f"\n{fill(f'# Headers: {source}', 108, subsequent_indent='# ')}")
        print(f"[{title}]\n{fill(' '.join(sorted(names)), 108, break_on_hyphens=False)}")


if __name__ == "__main__":
    main()
