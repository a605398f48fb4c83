"""A simulated vehicle for clients: started on ports of its own, stopped, its log replayed."""

import contextlib
import json
import math
import os
import pathlib
import random
import signal
import socket
import subprocess
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
MONITORING = ROOT / "missions" / "monitoring.plan"


def program():
    """The program, as WINDHOVER names it, or as a release build leaves it."""
    default = ROOT / "target" / "release" / "windhover"
    return os.environ.get("WINDHOVER", str(default))


def free_port(kind):
    """A port that nobody uses now."""
    with contextlib.closing(socket.socket(socket.AF_INET, kind)) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Vehicle:
    """`windhover sitl` as a child, whose end is always waited for."""

    greeting = "windhover sitl:"
    """How its first line begins."""
    patience = 60
    """It has so long to end, s."""

    def __init__(self, speed=10, options=()):
        self.speed, self.start = speed, time.monotonic()
        self.udp = free_port(socket.SOCK_DGRAM)
        self.folder = tempfile.TemporaryDirectory(prefix="windhover-sitl-")
        self.log = pathlib.Path(self.folder.name) / "flight.ulg"
        self.options = options

    def __enter__(self):
        # Between being found and being used, a port may be taken by somebody else.
        for _ in range(3):
            self._launch()
            if self.begun.wait(20) and self.lines[0].startswith(self.greeting):
                return self
            self.child.kill()
            self.child.wait()
        self.folder.cleanup()
        raise RuntimeError(f"the vehicle does not start: {self.lines}")

    def command(self):
        """What is run, but for where, how fast, and the options."""
        return [program(), "sitl", "--out", self.folder.name]

    def _launch(self):
        self.tcp = free_port(socket.SOCK_STREAM)
        command = [
            *self.command(),
            "--udp", f"127.0.0.1:{self.udp}",
            "--tcp", str(self.tcp),
            "--speed", str(self.speed),
            *self.options,
        ]
        self.child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines, self.begun = [], threading.Event()
        threading.Thread(target=self._listen, args=(self.child, self.lines, self.begun), daemon=True).start()

    def elapsed(self):
        """Simulated seconds since the start."""
        return (time.monotonic() - self.start) * self.speed

    @staticmethod
    def _listen(child, lines, begun):
        for line in child.stdout:
            lines.append(line.rstrip())
            begun.set()

    def __exit__(self, kind, *_):
        # One that has fallen has ended by itself.
        fell = self.child.poll() is not None
        if not fell:
            self.child.send_signal(signal.SIGINT)
        try:
            self.child.wait(self.patience)
        except subprocess.TimeoutExpired:
            self.child.kill()
            raise
        if kind is not None:
            print("the vehicle said:\n  " + "\n  ".join(self.lines[-60:]))
        else:
            code = self.child.returncode
            expect(code == int(fell), f"exit code {code}; the last lines: {self.lines[-5:]}")
            self.replay()
        self.folder.cleanup()

    def replay(self):
        """The log gives the same flight again."""
        done = subprocess.run([program(), "replay", str(self.log)], capture_output=True, text=True)
        expect(done.returncode == 0 and done.stdout.startswith("equal"), done.stdout + done.stderr)
        print(f"  replay: {done.stdout.strip()}")


class Proxy:
    """A network between vehicle and client that loses, delays and repeats packets, from a seed.

    The vehicle speaks to `vehicle_port`, the client listens at `client_port`.
    """

    def __init__(self, vehicle_port, client_port, loss, jitter=0.0, repeats=0.0, seed=1):
        self.loss, self.jitter, self.repeats = loss, jitter, repeats
        self.random = random.Random(seed)
        self.near = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.near.bind(("127.0.0.1", vehicle_port))
        self.far = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.far.bind(("127.0.0.1", 0))
        self.client = ("127.0.0.1", client_port)
        self.vehicle = None
        self.lock = threading.Lock()
        self.running = True
        for loop in (self._down, self._up):
            threading.Thread(target=loop, daemon=True).start()

    def _pass(self, send):
        with self.lock:
            if self.random.random() < self.loss:
                return
            copies = 2 if self.random.random() < self.repeats else 1
            waits = [self.random.random() * self.jitter for _ in range(copies)]
        for wait in waits:
            if wait > 0:
                threading.Timer(wait, send).start()
            else:
                send()

    def _down(self):
        while self.running:
            packet, self.vehicle = self.near.recvfrom(2048)
            self._pass(lambda packet=packet: self._send(self.far, packet, self.client))

    def _up(self):
        while self.running:
            packet, _ = self.far.recvfrom(2048)
            if self.vehicle is not None:
                self._pass(lambda packet=packet: self._send(self.near, packet, self.vehicle))

    def _send(self, port, packet, to):
        if self.running:
            with contextlib.suppress(OSError):
                port.sendto(packet, to)

    def close(self):
        """Nothing passes any more."""
        self.running = False
        for port in (self.near, self.far):
            with contextlib.suppress(OSError):
                port.shutdown(socket.SHUT_RDWR)


def expect(holds, what):
    """What must hold."""
    if not holds:
        raise AssertionError(what)


def wait_for(what, holds, seconds=60.0):
    """Looks until something holds; what it was if it never does."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = holds()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"not within {seconds} s: {what}")


def plan_items(path=MONITORING):
    """The items of a plan as (frame, command, autocontinue, params 1 to 4, x, y, z)."""
    items = []
    for item in json.loads(path.read_text())["mission"]["items"]:
        params = [math.nan if value is None else float(value) for value in item["params"]]
        x, y = (0 if math.isnan(value) else round(value * 1e7) for value in params[4:6])
        items.append((item["frame"], item["command"], int(item["autoContinue"]), params[:4], x, y, params[6]))
    return items


def many_items(count):
    """As many items as that: the monitoring plan with its waypoints repeated."""
    items = plan_items()
    first, middle = items[:1], items[1:]
    while len(first) + len(middle) < count:
        middle.extend(items[1:])
    return (first + middle)[:count]
