"""The flashed firmware on the emulated board: parameters and missions/monitoring.plan by upload, a restart, power
away, and the flight with its ten photos from what the flash kept.

usage: hil_monitoring.py [--twice]

With --twice the mission is flown also before power was away.
"""

import pathlib
import sys
import tempfile
import time

from hil import Board
from sitl import expect, plan_items
from station import ARM, VEHICLE, Station, mav, same

# The emulated sensors need no calibration: they are said to have one.
CALIBRATED = ("CAL_GYRO0_ID", "CAL_ACC0_ID", "CAL_MAG0_ID")
# Not its default.
HEIGHT = ("RTL_RETURN_ALT", 42.0)
# Heartbeats by the clock, s: so many that none is missed by the board's time, should that run faster.
BEAT = 0.2
# Time-outs by the clock, s, for what takes seconds of the board's time, should that run slower.
LONG = 600.0


def connect(board):
    """A station that the board speaks to first."""
    return Station(f"udpin:127.0.0.1:{board.udp}", beat=BEAT)


def list_parameters(station):
    """All of them come by a list, none is lost on the way: nothing is sent that finds no room."""
    station.send.param_request_list_send(*VEHICLE)
    found, count = {}, None
    while count is None or len(found) < count:
        value = station.wait("PARAM_VALUE", seconds=5)
        if value is None:
            break
        found[value.param_index], count = value.param_id, value.param_count
    expect(count is not None, "parameters come")
    expect(not set(range(count)) - set(found), f"{len(found)} of {count} parameters come")
    expect(len(set(found.values())) == count, f"{count} names")
    return count


def parameter(station, name, value=None, tries=5):
    """Reads or sets a parameter, again when no answer comes: a serial line may lose a frame."""
    answers = (station.parameter(name, value) for _ in range(tries))
    return next((answer for answer in answers if answer is not None), None)


def prepare(station, items):
    """What a builder does once: parameters, the mission."""
    heartbeat = station.find("a heartbeat", "HEARTBEAT")
    expect(heartbeat.type == mav.MAV_TYPE_QUADROTOR and not station.armed, "a quadrotor, not armed")
    count = list_parameters(station)
    for name, value in [*((name, 1.0) for name in CALIBRATED), HEIGHT]:
        expect(parameter(station, name, value) == value, f"{name} is set")
    begin = time.monotonic()
    result = station.upload(items, patience=5.0)
    expect(result == mav.MAV_MISSION_ACCEPTED, f"the mission: {result}, {station.texts}")
    print(f"  {count} parameters; {len(items)} items in {time.monotonic() - begin:.2f} s")


def is_kept(station, items):
    """All is as it was prepared."""
    for name, value in [*((name, 1.0) for name in CALIBRATED), HEIGHT]:
        found = parameter(station, name)
        expect(found == value, f"{name} is kept: {found}")
    expect(same(station.download(patience=5.0), items), "the mission is kept, bit for bit")


def rest(station, seconds):
    """Waits by the board's time."""
    begin = station.find("a time", "SYSTEM_TIME").time_boot_ms
    enough = lambda message: message.time_boot_ms - begin >= seconds * 1000  # noqa: E731
    station.find(f"{seconds} s later", "SYSTEM_TIME", enough, LONG)


def reboot(station):
    """A restart by command: the board's time begins anew."""
    before = station.find("a time", "SYSTEM_TIME").time_boot_ms
    station.order(mav.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1)
    anew = lambda message: message.time_boot_ms < before  # noqa: E731
    station.find("a start", "SYSTEM_TIME", anew, LONG)


def fly(station):
    """The mission, ten photos, the way home."""
    station.photos.clear()
    bit = mav.MAV_SYS_STATUS_PREARM_CHECK
    healthy = lambda status: status.onboard_control_sensors_health & bit  # noqa: E731
    station.find("it can be armed", "SYS_STATUS", healthy, LONG)
    expect(station.set_mode(4, 4) == mav.MAV_RESULT_ACCEPTED, f"mode mission: {station.texts}")
    station.order(ARM, 1)
    station.until("ten photos", lambda: len(station.photos) >= 10, LONG)
    station.until("hold at the end", lambda: station.mode == (4, 3), LONG)
    station.order(mav.MAV_CMD_NAV_RETURN_TO_LAUNCH)
    station.until("landed and disarmed", lambda: not station.armed, LONG)
    expect([photo.image_index for photo in station.photos] == list(range(10)), "each photo once")
    places = {(photo.lat, photo.lon) for photo in station.photos}
    expect(len(places) == 10, f"ten places: {places}")
    heights = [photo.relative_alt / 1000 for photo in station.photos]
    expect(all(abs(height - 30) < 1 for height in heights), f"30 m high: {heights}")
    print(f"  ten photos at {min(heights):.2f} to {max(heights):.2f} m; items reached: {station.reached}")


def main():
    """All of it."""
    twice = "--twice" in sys.argv[1:]
    items = plan_items()
    with tempfile.TemporaryDirectory(prefix="windhover-hil-") as folder:
        flash = pathlib.Path(folder) / "board.flash"
        with Board(flash) as board:
            station = connect(board)
            prepare(station, items)
            # Parameters rest before they are stored.
            rest(station, 3)
            reboot(station)
            is_kept(station, items)
            by_tcp = Station(f"tcp:127.0.0.1:{board.tcp}", system=254, beat=BEAT)
            is_kept(by_tcp, items)
            by_tcp.close()
            if twice:
                fly(station)
            station.close()
        with Board(flash) as board:
            station = connect(board)
            is_kept(station, items)
            fly(station)
            station.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
