"""Programs that write a table between marks of a page find their marks there: without them it is added to its end."""

import pytest

from benchmarks.accuracy import twin_seeds
from benchmarks.speed import twins


@pytest.mark.parametrize("mark", ["times", "hour", "noise"])
def test_a_table_of_twins_takes_the_place_of_the_one_before_and_the_rest_of_the_page_stays(mark, tmp_path, monkeypatch):
    before = twins.PAGE.read_text(encoding="utf8")
    page = tmp_path / "page.md"
    page.write_text(before, encoding="utf8")
    monkeypatch.setattr(twins, "PAGE", page)
    twins.write(mark, "| a |\n")
    after = page.read_text(encoding="utf8").splitlines()
    begin = after.index(f"<!-- {mark}: written by benchmarks/speed/twins.py -->")
    assert after[begin + 1 : begin + 3] == ["| a |", f"<!-- end of {mark} -->"]
    lines = before.splitlines()
    end = lines.index(f"<!-- end of {mark} -->")
    assert after[: begin + 1] == lines[: begin + 1]
    assert after[begin + 2 :] == lines[end:]


def test_the_tables_over_many_seeds_take_the_place_of_those_before(tmp_path, monkeypatch, capsys):
    before = twin_seeds.PAGE.read_text(encoding="utf8")
    page = tmp_path / "page.md"
    page.write_text(before, encoding="utf8")
    monkeypatch.setattr(twin_seeds, "PAGE", page)
    monkeypatch.setattr(twin_seeds, "text_of", lambda only, seeds: "| a |\n")
    twin_seeds.main(["--seeds", "3"])
    above, _, rest = before.partition(twin_seeds.BEGIN)
    below = rest.partition(twin_seeds.END)[2]
    assert rest and below
    assert page.read_text(encoding="utf8") == f"{above}{twin_seeds.BEGIN}3 seeds:\n\n| a |\n{twin_seeds.END}{below}"
