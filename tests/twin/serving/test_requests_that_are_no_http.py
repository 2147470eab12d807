"""What whoever reaches the port of the page can write on the standard error of the twin: nothing."""

import logging
import socket
import threading

import pytest
from twin.serving.lookers import UNITS

from crane.application import Crane
from tautline.twin.page.server import TALKER, Page

pytest.importorskip("uvicorn", reason="the page needs the extra `live`")


def send_nonsense(port):
    with socket.create_connection(("127.0.0.1", port), timeout=5.0) as one:
        one.sendall(b"\x16\x03\x01 hello\r\n\r\n")
        while one.recv(1024):
            pass


def without_handlers(monkeypatch):
    """The logger of uvicorn as it is in the command: pytest has handlers from the begin of a test on."""
    found = logging.getLogger(TALKER)
    monkeypatch.setattr(found, "propagate", False)
    monkeypatch.setattr(found, "handlers", [])
    return found


def test_a_request_that_is_no_http_prints_nothing_and_logging_is_as_before_when_the_page_is_closed(monkeypatch, capfd):
    logger = without_handlers(monkeypatch)
    page = Page(0, "a hoist", UNITS, Crane())
    try:
        send_nonsense(page.port)
    finally:
        page.close()
    assert capfd.readouterr().err == ""
    assert logger.filters == []


def test_a_warning_of_another_server_in_the_process_is_still_printed(monkeypatch, capfd):
    logger = without_handlers(monkeypatch)
    page = Page(0, "a hoist", UNITS, Crane())
    try:
        other = threading.Thread(target=logger.warning, args=("of another server",))
        other.start()
        other.join()
    finally:
        page.close()
    assert capfd.readouterr().err == "of another server\n"


def test_a_process_with_a_handler_of_its_own_still_gets_the_warning(monkeypatch):
    logger = without_handlers(monkeypatch)
    heard = []
    handler = logging.Handler()
    handler.emit = lambda record: heard.append(record.getMessage())
    logger.addHandler(handler)
    page = Page(0, "a hoist", UNITS, Crane())
    try:
        send_nonsense(page.port)
    finally:
        page.close()
    assert len(heard) == 1 and "Invalid HTTP request" in heard[0]
