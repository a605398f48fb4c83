"""MAVProxy: load a mission, list it, save it, arm, fly it.

usage: mavproxy_flight.py
"""

import math
import pathlib
import subprocess
import sys
import tempfile
import threading

from sitl import Vehicle, expect, plan_items, wait_for


def write_waypoints(path, items):
    """A waypoint file, as MAVProxy and Mission Planner write it."""
    lines = ["QGC WPL 110"]
    for seq, (frame, command, go_on, params, x, y, z) in enumerate(items):
        numbers = [f"{0.0 if math.isnan(value) else value:.8f}" for value in (*params, z)]
        numbers[4:4] = [f"{x * 1e-7:.8f}", f"{y * 1e-7:.8f}"]
        lines.append("\t".join([str(seq), str(int(seq == 0)), str(frame), str(command), *numbers, str(go_on)]))
    path.write_text("\n".join(lines) + "\n")


def read_waypoints(path):
    """What a waypoint file says, number by number."""
    rows = [line.split() for line in path.read_text().splitlines()[1:] if line.strip()]
    # Which item is the current one is the vehicle's to say.
    return [[float(value) for number, value in enumerate(row) if number != 1] for row in rows]


def differs(was, found):
    """Whether two items differ by more than the six decimals that MAVProxy writes."""
    return any(abs(one - other) > 1.1e-6 for one, other in zip(was, found))


class MavProxy:
    """MAVProxy as a child that is spoken to line by line."""

    def __init__(self, port, folder):
        program = pathlib.Path(sys.executable).parent / "mavproxy.py"
        self.said = []
        self.child = subprocess.Popen(
            [sys.executable, str(program), f"--master=udpin:127.0.0.1:{port}", "--logfile=flight.tlog",
             "--streamrate=-1", "--default-modules=wp,arm,cmdlong"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder,
        )
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        for line in self.child.stdout:
            self.said.append(line.rstrip())

    def say(self, command):
        """Gives a command."""
        self.child.stdin.write(command + "\n")
        self.child.stdin.flush()

    def heard(self, words):
        """Whether that was said."""
        return any(words in line for line in self.said)

    def close(self):
        """Ends it."""
        self.child.kill()
        self.child.wait()


def main():
    """All of it."""
    with tempfile.TemporaryDirectory(prefix="windhover-mavproxy-") as folder, Vehicle(speed=20) as vehicle:
        folder = pathlib.Path(folder)
        write_waypoints(folder / "mission.txt", plan_items())
        count = len(plan_items())
        proxy = MavProxy(vehicle.udp, folder)
        try:
            wait_for("MAVProxy hears the vehicle", lambda: proxy.heard("Detected vehicle"), 30)
            proxy.say("wp load mission.txt")
            wait_for("the mission is loaded", lambda: proxy.heard("ACCEPTED"), 30)
            proxy.say("wp list")
            wait_for("it is listed", lambda: proxy.heard("Saved") or proxy.heard(f"Requesting {count} waypoints"), 30)
            proxy.say("wp save back.txt")
            saved = folder / "back.txt"
            wait_for("it is saved", lambda: saved.exists() and len(read_waypoints(saved)) == count, 30)
            sent, back = read_waypoints(folder / "mission.txt"), read_waypoints(saved)
            wrong = [(seq, was, found) for seq, (was, found) in enumerate(zip(sent, back)) if differs(was, found)]
            expect(not wrong, f"it comes back as it was: {wrong[:3]}")
            wait_for("the position is known", lambda: vehicle.elapsed() > 15, 30)
            # Its commands for modes know PX4's names, and not how to send them.
            proxy.say("long MISSION_START 0 0 0 0 0 0 0")
            wait_for("mission", lambda: said(vehicle, "Mode: mission"), 20)
            proxy.say("arm throttle")
            wait_for("armed", lambda: said(vehicle, "Armed"), 20)
            wait_for("the mission is flown", lambda: said(vehicle, "Mission finished"), 60)
            proxy.say("long NAV_RETURN_TO_LAUNCH 0 0 0 0 0 0 0")
            wait_for("it has landed", lambda: said(vehicle, "Disarmed"), 60)
        except AssertionError:
            print("MAVProxy said:\n  " + "\n  ".join(proxy.said[-40:]))
            raise
        finally:
            proxy.close()
    return 0


def said(vehicle, words):
    """Whether the vehicle said that."""
    return any(words in line for line in vehicle.lines)


if __name__ == "__main__":
    sys.exit(main())
