"""Where the page of a twin is listened for, and under which names it is given."""

import socket
import urllib.error
import urllib.request

import pytest
from cli.in_process import commands_of
from twin.serving.lookers import UNITS

import tautline
from crane.application import Crane
from tautline.twin.page.hosts import bound, checked_names, place_of
from tautline.twin.page.server import Page

uvicorn = pytest.importorskip("uvicorn", reason="the page needs the extra `live`")

ELSEWHERE = "192.0.2.1"
"""An address of documents, RFC 5737: no computer has it."""


@pytest.fixture
def shown():
    """A function that shows a page at a host; it is closed after the test."""
    made = []

    def show(host, names=()):
        made.append(Page(0, "a hoist", UNITS, Crane(), host, names=names))
        return made[-1]

    yield show
    for one in made:
        one.close()


def asked(at, host, path="/"):
    """Status, text and headers of an answer to a request under a name."""
    request = urllib.request.Request(at + path, headers={"Host": host})
    try:
        with urllib.request.urlopen(request, timeout=5.0) as found:
            return found.status, "" if path == "/events" else found.read().decode(), found.headers
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode(), error.headers


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("8080", ("127.0.0.1", 8080)),
        ("0.0.0.0:8080", ("0.0.0.0", 8080)),
        ("[::1]:8080", ("::1", 8080)),
        ("::1:0", ("::1", 0)),
        ("rig.example.com:80", ("rig.example.com", 80)),
    ],
)
def test_a_place_is_a_port_with_a_name_or_an_address_before_it(text, place):
    assert place_of(text) == place


@pytest.mark.parametrize(
    ("text", "cure"),
    [
        ("http://127.0.0.1:8080", "write 127.0.0.1:8080"),
        ("http://127.0.0.1:8080/", "write 127.0.0.1:8080"),
        ("http://localhost", "write a number such as 8080"),
        ("localhost", "write a number such as 8080"),
        ("[::1]", "write a number such as 8080"),
        ("localhost:99999", "write a number such as 8080"),
    ],
)
def test_what_is_no_place_is_refused_with_what_to_write(text, cure):
    with pytest.raises(tautline.TautlineError, match=f"--serve .*{cure}"):
        place_of(text)


@pytest.mark.parametrize("host", [ELSEWHERE, "no such host", "nowhere.invalid"])
def test_a_host_that_is_not_this_computer_is_refused_by_its_name_and_not_by_the_port(host, shown):
    with pytest.raises(tautline.TautlineError, match="give a name or an address of this computer"):
        shown(host)


def test_a_page_at_an_address_of_ipv6_is_found_at_the_address_that_is_printed(shown):
    try:
        socket.create_server(("::1", 0), family=socket.AF_INET6).close()
    except OSError:
        pytest.skip("this computer has no IPv6")
    page = shown("::1")
    assert page.address == f"http://[::1]:{page.port}"
    assert asked(page.address, f"[::1]:{page.port}")[0] == 200


def test_a_page_for_all_computers_is_printed_with_this_ones_name_and_answers_to_its_names_and_addresses(shown):
    page = shown("0.0.0.0")
    assert page.address == f"http://{socket.gethostname()}:{page.port}"
    at = f"http://127.0.0.1:{page.port}"
    own = {socket.gethostname(), socket.getfqdn(), "10.1.2.3", "localhost"}
    assert {asked(at, f"{name}:{page.port}")[0] for name in own} == {200}


def test_a_name_that_was_given_is_answered_and_another_one_is_told_the_cure(shown):
    page = shown("127.0.0.1", ("twin.example.com",))
    assert asked(page.address, "twin.example.com")[0] == asked(page.address, "Twin.Example.com:443")[0] == 200
    status, text, _ = asked(page.address, "rig.example.com")
    assert status == 400 and "'rig.example.com'" in text and "--serve-name NAME" in text


def test_a_name_with_the_dot_of_the_root_or_an_empty_port_is_the_same_name(shown):
    at = shown("127.0.0.1", ("twin.example.com.",)).address
    names = ["localhost.", "localhost:", "localhost.:80", "twin.example.com", "twin.example.com.:443"]
    assert [asked(at, name)[0] for name in names] == [200] * len(names)
    assert [asked(at, name)[0] for name in ("localhost:evil", "evil.com:localhost")] == [400, 400]


@pytest.mark.parametrize("name", ["2001:db8::2", "[2001:db8::2]", "[2001:0DB8:0:0::2]"])
def test_an_address_of_ipv6_is_a_name_with_and_without_brackets(name, shown):
    assert asked(shown("127.0.0.1", checked_names([name], True)).address, "[2001:db8::2]:80")[0] == 200


@pytest.mark.parametrize("host", ["0", "000.0", "0.0.0.0"])
def test_all_forms_of_the_address_of_all_addresses_answer_any_name_and_print_two_places(host, shown):
    page = shown(host)
    assert page.addresses == [f"http://{socket.gethostname()}:{page.port}", f"http://localhost:{page.port}"]
    assert asked(page.addresses[1], "rig.example.com")[0] == 200


def led(monkeypatch, *places):
    """Let the name `localhost` lead to addresses."""
    whole = socket.getaddrinfo

    def found(host, port, *more, **named):
        if host != "localhost":
            return whole(host, port, *more, **named)
        six, four = (socket.AF_INET6, socket.SOCK_STREAM, 6, ""), (socket.AF_INET, socket.SOCK_STREAM, 6, "")
        return [(*six, (one, port, 0, 0)) if ":" in one else (*four, (one, port)) for one in places]

    monkeypatch.setattr(socket, "getaddrinfo", found)


@pytest.mark.parametrize("places", [("2001:db8::5", "127.0.0.1"), (ELSEWHERE, "127.0.0.1"), ("::1", "127.0.0.1")])
def test_a_name_is_listened_at_by_the_first_of_its_addresses_that_this_computer_has_ipv4_before_ipv6(
    places, monkeypatch
):
    led(monkeypatch, *places)
    with bound("localhost", 0) as made:
        assert made.getsockname()[0] == "127.0.0.1"


def test_a_port_that_is_taken_at_one_address_of_a_name_is_not_taken_at_another_one(monkeypatch):
    led(monkeypatch, "127.0.0.1", "::1")
    with bound("localhost", 0) as made, pytest.raises(tautline.TautlineError, match="give another port"):
        bound("localhost", made.getsockname()[1])


def test_events_tell_a_proxy_not_to_gather_them(shown):
    assert asked(shown("127.0.0.1").address, "localhost", "/events")[2]["X-Accel-Buffering"] == "no"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--serve-name", "twin.example.com"], "give --serve too"),
        (["--serve", "0", "--serve-name", "http://twin.example.com"], "write the name alone"),
        (["--serve", "0", "--serve-name", "twin.example.com:80"], "write the name alone"),
        (["--serve", "0", "--serve-name", "a b"], "write the name alone"),
        (["--serve", "0", "--serve-name", "*"], "a star stands for none"),
        (["--serve", "0", "--serve-name", "*.example.com"], "a star stands for none"),
        (["--serve", f"{ELSEWHERE}:0"], "give a name or an address of this computer"),
    ],
)
def test_names_and_hosts_that_cannot_be_end_with_2_and_write_nothing(words, said, tmp_path, capsys):
    (tmp_path / "map.yaml").write_text("sensors: [{column: a, unit: m, input: winch.pay_out}]\n")
    (tmp_path / "a.csv").write_text("time,a\n0,0\n")
    given = ["--map", tmp_path / "map.yaml", "--source", tmp_path / "a.csv", "-o", tmp_path / "twin.nc"]
    code, _, told = commands_of(Crane(), capsys)("twin", "data/hoist.yaml", *given, *words)
    assert code == 2 and said in " ".join(told.split())
    assert not (tmp_path / "twin.nc").exists()
