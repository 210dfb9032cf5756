"""How long the page waits for a loop: requests through the server, each with another width.

The time of the processor, of server and client, does not depend on what else the machine does.

python tests/benchmarks/explore.py [requests]
"""

from __future__ import annotations

import copy
import http.client
import json
import statistics
import sys
import threading
import time

from rbsdem.web.server import ExploreServer
from rbsdem.web.state import DEFAULT


def main(requests: int) -> None:
    """Print median and nearly largest time of each kind of answer."""
    with ExploreServer(0, DEFAULT) as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}).start()
        connection = http.client.HTTPConnection("127.0.0.1", server.port)
        print("| answer | requests | median, ms | 95 %, ms | processor, ms | kB |")
        print("| --- | ---: | ---: | ---: | ---: | ---: |")
        number = 0
        for lane, count in (
            ("loops", requests),
            ("sections", requests // 2),
            ("bands", requests // 2),
            ("own", max(2, requests // 10)),
        ):
            seconds, size, before = [], 0, time.process_time()
            for i in range(count):
                number += 1
                state = copy.deepcopy(DEFAULT)
                width = 0.3 + 0.2 * i / count + 1e-5 * number
                for name, values in state["cases"][0]:
                    if name == "section":
                        values["width"] = width
                body = json.dumps({"tab": "benchmark", "number": number, "state": state})
                heads = {"Content-Type": "application/json"}
                begun = time.perf_counter()
                connection.request("POST", f"/{server.token}/{lane}", body, heads)
                answer = connection.getresponse()
                size = len(answer.read())
                seconds.append(time.perf_counter() - begun)
                assert answer.status == 200
            seconds.sort()
            late = seconds[int(0.95 * (len(seconds) - 1))]
            print(
                f"| {lane} | {count} | {1e3 * statistics.median(seconds):.0f} | {1e3 * late:.0f} "
                f"| {1e3 * (time.process_time() - before) / count:.0f} | {size / 1e3:.0f} |"
            )
        connection.close()
        server.shutdown()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 100)
