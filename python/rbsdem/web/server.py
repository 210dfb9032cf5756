"""The server of the page: on this machine alone, and for who knows its address alone.

It listens on 127.0.0.1. Every path begins with a random token; a request without it is refused. A
request whose Host or Origin is another one is refused, so that a page of another site gets no
answer even if it guesses the port. No request names a file: the page and its parts are read once
from the package, and what a user opens comes as text. One answer is computed at a time; of the
requests of a tab for the same thing the newest is answered, and older ones are told so.
"""

from __future__ import annotations

import json
import secrets
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar
from urllib.parse import urlsplit

from rbsdem.errors import InputError
from rbsdem.measured.specimens import Specimens
from rbsdem.web.answers import LANES, ONCE, Answers, defect
from rbsdem.web.pages import TYPES, parts
from rbsdem.web.report import report_of_page
from rbsdem.web.state import DEFAULT, RefusedError, building

#: Largest request [bytes]: a state, and the text of a file.
MOST_STATE, MOST_TEXT = 1_000_000, 8_000_000
#: Tabs that are known, requests at once.
_TABS, _AT_ONCE = 64, 32
#: Time in which a request must have come [s].
_PATIENCE = 20.0

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


class SupersededError(Exception):
    """A newer request of the same tab for the same thing has come."""


class ExploreServer(ThreadingHTTPServer):
    """The server.

    Parameters
    ----------
    port : int, optional
        0 takes a free one.
    start : mapping, optional
        The state that the page begins with, in place of its own.
    near : Specimens, optional
        Tests to compare with.

    Raises
    ------
    InputError
        If the port is taken, or not one.
    """

    daemon_threads = True
    allow_reuse_address = False

    def __init__(
        self,
        port: int = 0,
        start: Mapping[str, Any] | None = None,
        near: Specimens | None = None,
    ) -> None:
        if not 0 <= port <= 65535:
            raise InputError(f"--port {port}: a port is a number from 1 to 65535")
        try:
            super().__init__(("127.0.0.1", port), _Handler)
        except OSError as error:
            raise InputError(
                f"--port {port}: cannot be opened ({error.strerror}); another program may have it: "
                "choose another port, or leave it out"
            ) from None
        self.token = secrets.token_urlsafe(24)
        self.start = start
        self.answers = Answers(near)
        self.parts = parts()
        self.computing = threading.Lock()
        self.room = threading.BoundedSemaphore(_AT_ONCE)
        self._newest: OrderedDict[tuple[str, str], int] = OrderedDict()
        self._newest_lock = threading.Lock()

    @property
    def port(self) -> int:
        """The port that it listens on."""
        return int(self.server_address[1])

    @property
    def address(self) -> str:
        """The address for the browser, with the token."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    # ---- newest wins ----------------------------------------------------------------------------

    def announce(self, tab: str, lane: str, number: int) -> Callable[[], None]:
        """Note the number of a request; return a check that raises if a newer one has come."""
        key = (tab, lane)
        with self._newest_lock:
            self._newest[key] = max(number, self._newest.get(key, number))
            self._newest.move_to_end(key)
            while len(self._newest) > _TABS * len(LANES):
                self._newest.popitem(last=False)

        def check() -> None:
            with self._newest_lock:
                if self._newest.get(key, number) > number:
                    raise SupersededError

        return check

    # ---- what is asked --------------------------------------------------------------------------

    def answer(self, lane: str, asked: Mapping[str, Any]) -> dict[str, Any]:
        """Return the answer to what the page asks.

        Raises
        ------
        RefusedError
            If the request is none of the page's.
        SupersededError
            If a newer one of the tab is here.
        """
        tab, number = asked.get("tab"), asked.get("number")
        if not isinstance(tab, str) or len(tab) > 64 or type(number) is not int:
            raise RefusedError(400, "tab must be a short text and number a whole number")
        check = None if lane in ONCE else self.announce(tab, lane, number)

        def pause() -> None:
            """Let another answer be computed, and end this one if a newer request has come."""
            # Another answer is computed first: a loop is waited for, a band is not.
            self.computing.release()
            try:
                threading.Event().wait(0.001)
            finally:
                self.computing.acquire()
            if check is not None:
                check()

        with self.computing:
            if check is not None:
                check()
            if lane == "report":
                return {"number": number, **report_of_page(self.answers, asked)}
            return {"number": number, **getattr(self.answers, lane)(asked, pause)}


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: ExploreServer
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "rbsdem", ""
    # Head and body of an answer go out at once, and nobody waits for more.
    wbufsize = -1
    disable_nagle_algorithm = True
    timeout = _PATIENCE
    #: Heads of every answer.
    _heads: ClassVar[dict[str, str]] = {
        "Content-Security-Policy": _POLICY,
        "Cache-Control": "no-store",
        "Referrer-Policy": "no-referrer",
        "X-Content-Type-Options": "nosniff",
        "X-Frame-Options": "DENY",
        "Cross-Origin-Opener-Policy": "same-origin",
        "Cross-Origin-Resource-Policy": "same-origin",
    }

    def do_GET(self) -> None:
        """Send the page or one of its parts."""
        self._guarded(self._get)

    def do_POST(self) -> None:
        """Answer a question of the page."""
        self._guarded(self._post)

    def _guarded(self, work: Callable[[str], None]) -> None:
        """Do the work of a request, and answer whatever goes wrong in it."""
        if not self.server.room.acquire(blocking=False):
            self._refuse(503, "too many requests at once")
            return
        try:
            work(self._allowed())
        except RefusedError as error:
            self._refuse(error.status, str(error))
        except SupersededError:
            self._send(409, b'{"superseded": true}', "application/json")
        except (ConnectionError, TimeoutError):
            self.close_connection = True  # nobody waits for the answer
        except Exception as error:  # one of the program, which must not end the server
            self._refuse(500, defect(error))
        finally:
            self.server.room.release()

    def _allowed(self) -> str:
        """Check token, Host and Origin; return the rest of the path."""
        names = {f"{host}:{self.server.port}" for host in ("127.0.0.1", "localhost")}
        host = self.headers.get_all("Host") or []
        if len(host) != 1 or host[0].lower() not in names:
            raise RefusedError(403, "this address has another host")
        for origin in self.headers.get_all("Origin") or []:
            if origin.lower() != f"http://{host[0].lower()}":
                raise RefusedError(403, "another site must not ask here")
        if self.headers.get("Sec-Fetch-Site", "none") == "cross-site" and self.command == "POST":
            raise RefusedError(403, "another site must not ask here")
        _, _, rest = urlsplit(self.path).path.partition("/")
        token, _, path = rest.partition("/")
        known = self.server.token.encode()
        if not secrets.compare_digest(token.encode("utf-8", "surrogatepass"), known):
            raise RefusedError(404, "nothing is here; the address has a token that rbsdem printed")
        return path

    def _get(self, path: str) -> None:
        """Send what the page begins with, the page, or one of its parts."""
        if path == "start":
            near = self.server.answers.near is not None
            begin = {"state": self.server.start, "tests": near}
            begin |= {"columns": DEFAULT, "frame": building()}
            self._send(200, json.dumps(begin).encode(), "application/json")
            return
        name = path or "index.html"
        if name not in self.server.parts:
            raise RefusedError(404, "nothing is here")
        self._send(200, self.server.parts[name], TYPES[name.rsplit(".", 1)[1]])

    def _post(self, path: str) -> None:
        """Answer a question: the path is its lane, the body a JSON object."""
        if path not in LANES:
            raise RefusedError(404, "nothing is here")
        if self.headers.get_content_type() != "application/json":
            raise RefusedError(415, "send application/json")
        asked = self._body(MOST_TEXT if path in ("open", "record") else MOST_STATE)
        answer = self.server.answer(path, asked)
        self._send(200, json.dumps(answer, allow_nan=False).encode(), "application/json")

    def _body(self, most: int) -> dict[str, Any]:
        """Return the body of a request, a JSON object without NaN."""
        length = self.headers.get("Content-Length", "")
        if self.headers.get("Transfer-Encoding") or not length.isascii() or not length.isdigit():
            raise RefusedError(411, "Content-Length is missing")
        if len(length) > 12 or int(length) > most:
            raise RefusedError(413, f"more than {most} bytes")
        raw = self.rfile.read(int(length))
        if len(raw) < int(length):
            raise ConnectionResetError
        try:
            asked = json.loads(raw, parse_constant=_no_constant, parse_int=_whole)
        except (ValueError, RecursionError) as error:
            raise RefusedError(400, f"this is not JSON: {error}") from None
        if not isinstance(asked, dict):
            raise RefusedError(400, "send an object")
        return asked

    def _refuse(self, status: int, text: str) -> None:
        """Send an error as JSON, and close the connection."""
        # The rest of the request is not read.
        self.close_connection = True
        with suppress(ConnectionError, TimeoutError):
            self._send(status, json.dumps({"error": text}).encode(), "application/json")

    def _send(self, status: int, body: bytes, kind: str) -> None:
        """Send an answer of a media type, with the heads of every answer."""
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        for name, value in self._heads.items():
            self.send_header(name, value)
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(body)
        self.wfile.flush()

    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002
        """Print nothing: the path has the token."""


def _whole(digits: str) -> int | float:
    """Return a whole number; one that no computer counts to becomes a float."""
    return int(digits) if len(digits) < 16 else float(digits)


def _no_constant(name: str) -> None:
    """Refuse NaN and Infinity, which Python reads and JSON does not have."""
    raise ValueError(f"{name} is no number of JSON")
