"""The text of a scene or a table, spoilt: encodings, line ends, odd bytes, lines and characters, YAML's own devices."""

from __future__ import annotations

import random
from collections.abc import Callable


def _marked(text: str, chance: random.Random) -> bytes:
    return text.encode(chance.choice(("utf-8-sig", "utf-16", "utf-32", "latin-1")), "replace")


def _with_carriage_returns(text: str, chance: random.Random) -> bytes:
    return text.replace("\n", chance.choice(("\r\n", "\r", "\n\r"))).encode()


def _with_a_tab(text: str, chance: random.Random) -> bytes:
    return text.replace("  ", "\t", chance.choice((1, 3, -1))).encode()


def _with_odd_bytes(text: str, chance: random.Random) -> bytes:
    at = chance.randrange(len(text) + 1)
    odd = chance.choice((b"\0", b"\xff", b"\x1b[31m", b"\xc3", b"\xed\xa0\x80", b"\x07", "\u2028".encode(), b"\x85"))
    return text[:at].encode() + odd + text[at:].encode()


def _cut(text: str, chance: random.Random) -> bytes:
    return text[: chance.randrange(len(text) + 1)].encode()


def _with_lines_twice(text: str, chance: random.Random) -> bytes:
    lines = text.splitlines(keepends=True)
    at = chance.randrange(max(1, len(lines)))
    return "".join([*lines[: at + 1], *lines[at : at + chance.choice((1, 4))], *lines[at + 1 :]]).encode()


def _with_lines_shuffled(text: str, chance: random.Random) -> bytes:
    lines = text.splitlines(keepends=True)
    for _ in range(2):
        at = chance.randrange(max(1, len(lines)))
        lines[at : at + 2] = reversed(lines[at : at + 2])
    return "".join(lines).encode()


def _with_characters_changed(text: str, chance: random.Random) -> bytes:
    letters = list(text)
    for _ in range(chance.choice((1, 2, 5))):
        if letters:
            letters[chance.randrange(len(letters))] = chance.choice(":-[]{},#&*!|>'\"%@` \n\t0e9.?~")
    return "".join(letters).encode("utf8", "surrogatepass")


def _with_two_documents(text: str, chance: random.Random) -> bytes:
    between = ("---\n", "...\n", "---\na: 1\n", "--- !!python/none\n", "%YAML 9.9\n---\n")
    return (text + chance.choice(between) + text).encode()


def _with_aliases(text: str, chance: random.Random) -> bytes:
    bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n"
    for one, other in zip("abcdefgh", "bcdefghi", strict=True):
        bomb += f"{other}: &{other} [{', '.join(['*' + one] * 9)}]\n"
    heads = (
        bomb, "a: &a {b: *a}\n", "a: *b\n", "a: &a {x: 1}\nb: {<<: *a}\n", "<<: {a: 1}\n", "a: !!set {b}\n",
        "? [a]\n: 1\n",
        "a: !!binary aGVsbG8=\n", "a: !!timestamp 2001-01-01\n", "a: 2001-01-01\n", "a: !x 1\n",
        "a: &a 1\nb: &a 2\nc: *a\n",
        "a: !!python/object/apply:os.system ['true']\n", "a: " + "[" * 2000 + "\n",
        "a: " + "{a: " * 60 + "1" + "}" * 60 + "\n",
    )  # fmt: skip
    return (chance.choice(heads) + text).encode()


def _with_an_alias_of_its_own(text: str, chance: random.Random) -> bytes:
    lines = text.splitlines(keepends=True)
    ends = [i for i, line in enumerate(lines) if ": " in line]
    if len(ends) > 1:
        one, other = sorted(chance.sample(ends, 2))
        lines[one] = lines[one].replace(": ", ": &mark ", 1)
        lines[other] = lines[other].split(": ", 1)[0] + ": *mark\n"
    return "".join(lines).encode()


def _something_else(text: str, chance: random.Random) -> bytes:
    return chance.choice(
        (b"", b"\n", b"42\n", b"[]\n", b"{}\n", b"null\n", b"--- \n", b"\x89HDF\r\n\x1a\n" + bytes(range(256)),
         b"# nothing\n",
         b"'" * 99, b"a" * 100_000, b"PK\x03\x04" + bytes(200), b"<html></html>", b"- " * 3000 + b"1\n")
    )  # fmt: skip


SPELLINGS: tuple[Callable[[str, random.Random], bytes], ...] = (
    _marked, _with_carriage_returns, _with_a_tab, _with_odd_bytes, _cut, _with_lines_twice, _with_lines_shuffled,
    _with_characters_changed, _with_two_documents, _with_aliases, _with_an_alias_of_its_own, _something_else,
)  # fmt: skip
