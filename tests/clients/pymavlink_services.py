"""Every service of the link, as pymavlink sees it.

usage: pymavlink_services.py
"""

import socket
import sys
import time
from functools import partial

from sitl import Proxy, Vehicle, expect, free_port, many_items, plan_items
from station import ARM, NAN, VEHICLE, Station, mav, same

ACCEPTED = mav.MAV_RESULT_ACCEPTED
MISSION_ACCEPTED = mav.MAV_MISSION_ACCEPTED
FENCE, RALLY = mav.MAV_MISSION_TYPE_FENCE, mav.MAV_MISSION_TYPE_RALLY
LATITUDE, LONGITUDE = 473977418, 85455938


def identity(station):
    """Who the vehicle says it is."""
    heartbeat = station.wait("HEARTBEAT")
    expect(heartbeat.autopilot == mav.MAV_AUTOPILOT_PX4, "PX4 by default")
    expect(heartbeat.type == mav.MAV_TYPE_QUADROTOR and heartbeat.get_srcComponent() == 1, "a quadrotor")
    station.order(mav.MAV_CMD_REQUEST_MESSAGE, 148)
    version = station.wait("AUTOPILOT_VERSION")
    for name in ("MISSION_INT", "COMMAND_INT", "MAVLINK2", "MISSION_FENCE", "MISSION_RALLY"):
        bit = getattr(mav, f"MAV_PROTOCOL_CAPABILITY_{name}")
        expect(version.capabilities & bit, f"it can do {name}")
    result, _ = station.command(mav.MAV_CMD_REQUEST_MESSAGE, 9999)
    expect(result not in (ACCEPTED, None), "there is no such message")


def parameters(station):
    """Listed, read, set, refused."""
    station.send.param_request_list_send(*VEHICLE)
    found = {}
    while True:
        value = station.wait("PARAM_VALUE", seconds=2)
        if value is None:
            break
        found[value.param_id] = value
        if len(found) == value.param_count:
            break
    expect(len(found) == value.param_count, f"{len(found)} of {value.param_count} came")
    expect(all(value.param_type == mav.MAV_PARAM_TYPE_REAL32 for value in found.values()), "all are floats")
    for name in ("SYS_AUTOSTART", "COM_RC_IN_MODE", "RTL_RETURN_ALT", "MIS_TAKEOFF_ALT", "NAV_RCL_ACT"):
        expect(name in found, f"ground stations look for {name}")
    by_name = station.parameter("MPC_XY_CRUISE")
    expect(by_name == found["MPC_XY_CRUISE"].param_value, "by name as in the list")
    expect(station.parameter("MPC_XY_CRUISE", 3.5) == 3.5, "it is set")
    expect(station.parameter("MPC_XY_CRUISE", 1e9) == 3.5, "out of range it stays")
    expect(station.parameter("MPC_XY_CRUISE", NAN) == 3.5, "what is no number is refused")
    expect(station.parameter("NO_SUCH_THING") is None, "there is no such parameter")
    expect(station.parameter("MPC_XY_CRUISE", by_name) == by_name, "and back")


def missions(station, vehicle):
    """Uploads and downloads, whole, wrong, interrupted."""
    items = many_items(250)
    begin = time.monotonic()
    expect(station.upload(items) == MISSION_ACCEPTED, f"250 items: {station.texts}")
    up = time.monotonic() - begin
    begin = time.monotonic()
    expect(same(station.download(), items), "they come back bit for bit")
    down = time.monotonic() - begin
    expect(up < 5 and down < 5, f"upload {up:.2f} s, download {down:.2f} s")
    print(f"  250 items: upload {up:.2f} s, download {down:.2f} s")
    # One that is not flown, with its reason; the stored one stays.
    wrong = plan_items()
    wrong[3] = (3, 84, 1, [0.0] * 4, LATITUDE, LONGITUDE, 10.0)
    result = station.upload(wrong)
    expect(result == mav.MAV_MISSION_UNSUPPORTED, f"a VTOL takeoff: {result}")
    station.until("the item is named", lambda: any("item 3" in text for text in station.texts), 5)
    # Interrupted, and with a wrong sequence; not so soon that it may be left over from the last one.
    station.wait("MISSION_ACK", seconds=1.5)
    station.send.mission_count_send(*VEHICLE, 10, 0)
    station.wait("MISSION_REQUEST_INT")
    station.send_item(7, items[7])
    answer = station.wait("MISSION_ACK")
    expect(answer is not None and answer.type == mav.MAV_MISSION_INVALID_SEQUENCE, f"{answer}")
    station.send.mission_count_send(*VEHICLE, 10, 0)
    station.wait("MISSION_REQUEST_INT")
    station.send.mission_ack_send(*VEHICLE, mav.MAV_MISSION_OPERATION_CANCELLED, 0)
    # Two at once: the second one is refused, and the first one goes on.
    other = Station(f"tcp:127.0.0.1:{vehicle.tcp}", system=254)
    station.send.mission_count_send(*VEHICLE, 10, 0)
    station.wait("MISSION_REQUEST_INT")
    other.send.mission_count_send(*VEHICLE, 5, 0)
    answer = other.wait("MISSION_ACK")
    expect(answer is not None and answer.type != MISSION_ACCEPTED, f"the second one: {answer}")
    other.close()
    station.send.mission_ack_send(*VEHICLE, mav.MAV_MISSION_OPERATION_CANCELLED, 0)
    expect(same(station.download(), items), "the stored one is as it was")


def fences(station):
    """Fence and rally points; clearing."""
    corners = [(-2000, -2000), (-2000, 9000), (9000, 9000), (9000, -2000)]
    fence = [
        (3, mav.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, 1, [4.0, 0.0, 0.0, 0.0],
         LATITUDE + north * 10, LONGITUDE + east * 10, 0.0)
        for north, east in corners
    ]
    rally = [(3, mav.MAV_CMD_NAV_RALLY_POINT, 1, [0.0] * 4, LATITUDE + 500, LONGITUDE, 20.0)]
    for kind, items in ((FENCE, fence), (RALLY, rally)):
        expect(station.upload(items, kind) == MISSION_ACCEPTED, f"kind {kind}: {station.texts[-3:]}")
        expect(same(station.download(kind), items), f"kind {kind} comes back")
        station.send.mission_clear_all_send(*VEHICLE, kind)
        expect(station.wait("MISSION_ACK").type == MISSION_ACCEPTED, f"kind {kind} is cleared")
        expect(station.download(kind) == [], f"kind {kind} is empty")


def commands(station):
    """What is answered, how, and how soon."""
    station.order(mav.MAV_CMD_SET_MESSAGE_INTERVAL, 32, 20_000)
    station.wait("LOCAL_POSITION_NED")
    station.order(mav.MAV_CMD_GET_MESSAGE_INTERVAL, 32)
    expect(station.wait("MESSAGE_INTERVAL").interval_us == 20_000, "the interval")
    largest = 0.0
    for command, params, wanted, integers in [
        (31999, [], (mav.MAV_RESULT_UNSUPPORTED,), False),
        (31999, [], (mav.MAV_RESULT_UNSUPPORTED,), True),
        (mav.MAV_CMD_DO_SET_HOME, [1], (ACCEPTED,), False),
        (mav.MAV_CMD_DO_SET_ROI_LOCATION, [0, 0, 0, 0, LATITUDE, LONGITUDE, 10], (ACCEPTED,), True),
        (mav.MAV_CMD_DO_SET_ROI_NONE, [], (ACCEPTED,), False),
        (mav.MAV_CMD_IMAGE_START_CAPTURE, [0, 0, 1], (ACCEPTED,), False),
        (mav.MAV_CMD_RUN_PREARM_CHECKS, [], (ACCEPTED,), False),
        (mav.MAV_CMD_DO_REPOSITION, [-1, 0, 0, NAN, LATITUDE, LONGITUDE, 500],
         (mav.MAV_RESULT_TEMPORARILY_REJECTED,), True),
        (mav.MAV_CMD_NAV_LAND, [0, 0, 0, NAN, NAN, NAN], (mav.MAV_RESULT_TEMPORARILY_REJECTED,), False),
        (mav.MAV_CMD_PREFLIGHT_STORAGE, [1], (ACCEPTED,), False),
        (mav.MAV_CMD_DO_SET_MISSION_CURRENT, [2], (ACCEPTED,), False),
    ]:
        result, took = station.command(command, *params, integers=integers)
        expect(result in wanted, f"command {command}: {result}, not {wanted}; {station.texts[-4:]}")
        largest = max(largest, took)
        again = station.wait("COMMAND_ACK", seconds=0.1)
        expect(again is None, f"command {command} is answered twice: {again}")
    current = station.wait("MISSION_CURRENT", lambda message: message.seq == 2)
    expect(current is not None, "the current item is told")
    station.send.mission_set_current_send(*VEHICLE, 0)
    expect(station.wait("MISSION_CURRENT", lambda message: message.seq == 0) is not None, "and the old way")
    expect(largest < 0.5, f"the slowest answer took {largest:.3f} s")
    print(f"  slowest answer: {largest * 1000:.1f} ms")


def small_talk(station):
    """Time, ping, files."""
    station.send.timesync_send(0, 123_456_789)
    answer = station.wait("TIMESYNC", lambda message: message.tc1 != 0)
    expect(answer is not None and answer.ts1 == 123_456_789, f"{answer}")
    station.send.ping_send(5, 77, 0, 0)
    answer = station.wait("PING", lambda message: message.seq == 77)
    expect(answer is not None and answer.target_system == 255, f"{answer}")
    payload = [0, 0, 0, 3, 0] + [0] * 246
    station.send.file_transfer_protocol_send(0, *VEHICLE, payload)
    expect(station.wait("FILE_TRANSFER_PROTOCOL", seconds=1) is not None, "files are refused at once")


def motors(station):
    """One motor of a disarmed vehicle; none of an armed one."""
    station.order(mav.MAV_CMD_DO_MOTOR_TEST, 2, 0, 15, 1)
    turning = station.wait("SERVO_OUTPUT_RAW", lambda out: out.servo2_raw > 1100 and out.servo1_raw <= 1100)
    expect(turning is not None, "motor 2 turns, and motor 1 does not")
    stopped = station.wait("SERVO_OUTPUT_RAW", lambda out: out.servo2_raw <= 1100, 10)
    expect(stopped is not None, "it stops by itself")
    station.order(ARM, 1)
    result, _ = station.command(mav.MAV_CMD_DO_MOTOR_TEST, 2, 0, 15, 1)
    expect(result != ACCEPTED, "not while armed")
    station.order(ARM, 0)
    result, _ = station.command(mav.MAV_CMD_DO_MOTOR_TEST, 2, 0, 150, 1)
    expect(result == mav.MAV_RESULT_DENIED, "150 % is no throttle")


def air(station):
    """In the air: go there, faster, sticks, setpoints, kill."""
    station.order(ARM, 1)
    station.order(mav.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, NAN, NAN, NAN, 500.0)
    station.until("it hovers", lambda: station.mode == (4, 3))
    station.order(mav.MAV_CMD_DO_CHANGE_ALTITUDE, 510.0, 0)
    north = LATITUDE + 2000
    result, _ = station.command(
        mav.MAV_CMD_DO_REPOSITION, -1, 0, 0, NAN, north, LONGITUDE, 505.0, integers=True
    )
    expect(result == ACCEPTED, f"go there: {station.texts[-4:]}")
    there = station.wait("GLOBAL_POSITION_INT", lambda place: abs(place.lat - north) < 100, 60)
    expect(there is not None, "it is there")
    result, _ = station.command(
        mav.MAV_CMD_DO_REPOSITION, -1, 0, 0, NAN, north + 10_000_000, LONGITUDE, 505.0, integers=True
    )
    expect(result != ACCEPTED, "a hundred kilometres are too far")
    for _ in range(20):
        station.send.manual_control_send(1, 500, 0, 500, 0, 0)
        station.look(0.05)
    expect(station.set_mode(3) == ACCEPTED, f"position mode: {station.texts[-4:]}")
    station.send.manual_control_send(1, 500, 0, 500, 0, 0)
    moving = False
    for _ in range(200):
        station.send.manual_control_send(1, 500, 0, 500, 0, 0)
        message = station.wait("LOCAL_POSITION_NED", seconds=0.1)
        moving = moving or (message is not None and abs(message.vx) + abs(message.vy) > 0.8)
    expect(moving, "sticks move it")
    station.order(mav.MAV_CMD_DO_PAUSE_CONTINUE, 0)
    result, _ = station.command(mav.MAV_CMD_DO_FLIGHTTERMINATION, 1)
    expect(result == ACCEPTED, "a kill")
    station.until("the motors are off", lambda: not station.armed, 5)


def signing(vehicle):
    """With a key only those who have it are heeded, until it is taken back."""
    station = Station(f"udpin:127.0.0.1:{vehicle.udp}")
    station.ready()
    key, other_key = bytes(range(32)), bytes(range(1, 33))
    # 10 µs since 2015: pymavlink believes nothing older than its own clock.
    station.send.setup_signing_send(*VEHICLE, list(key), int((time.time() - 1_420_070_400) * 1e5))
    sign = partial(station.link.setup_signing, allow_unsigned_callback=lambda *_: True)
    sign(key, sign_outgoing=False)
    station.find("a signed heartbeat", "HEARTBEAT", lambda message: message.get_signed())

    def unheeded(what):
        station.drain()
        station.send.command_long_send(*VEHICLE, ARM, 0, 1, 0, 0, 0, 0, 0, 0)
        expect(station.wait("COMMAND_ACK", seconds=0.5) is None and not station.armed, f"{what} is heeded")

    unheeded("an unsigned command")
    sign(other_key, sign_outgoing=True)
    unheeded("a command signed with another key")
    sign(key, sign_outgoing=True)
    station.order(ARM, 1)
    station.order(ARM, 0)
    station.send.setup_signing_send(*VEHICLE, [0] * 32, 0)
    station.link.disable_signing()
    station.find("an unsigned heartbeat", "HEARTBEAT", lambda message: not message.get_signed())
    station.order(ARM, 1)
    station.order(ARM, 0)
    station.close()


def loss():
    """A client without a limit, at 20 % loss both ways, with 30 ms of jitter and 2 % duplicates."""
    with Vehicle(speed=1) as vehicle:
        port = free_port(socket.SOCK_DGRAM)
        proxy = Proxy(vehicle.udp, port, 0.2, jitter=0.03, repeats=0.02, seed=3)
        station = Station(f"udpin:127.0.0.1:{port}")
        items = many_items(250)
        begin = time.monotonic()
        expect(station.upload(items, patience=3.0) == MISSION_ACCEPTED, "the upload comes through")
        up = time.monotonic() - begin
        expect(same(station.download(patience=0.15), items), "and comes back equal")
        print(f"  250 items at 20 % loss: upload {up:.1f} s, download {time.monotonic() - begin - up:.1f} s")
        station.close()
        proxy.close()


def blockers():
    """Arming names what speaks against it."""
    with Vehicle(speed=1) as vehicle:
        station = Station(f"tcp:127.0.0.1:{vehicle.tcp}")
        result, _ = station.command(ARM, 1)
        expect(result != ACCEPTED, "it does not arm without a position")
        station.until("a reason", lambda: any("refused" in text for text in station.texts), 5)
        print(f"  {[text for text in station.texts if 'refused' in text]}")
        station.close()


def main():
    """All of it."""
    blockers()
    with Vehicle(speed=5) as vehicle:
        station = Station(f"udpin:127.0.0.1:{vehicle.udp}")
        station.ready()
        for service in (identity, parameters, fences, small_talk):
            print(service.__name__)
            service(station)
        print("missions")
        missions(station, vehicle)
        for service in (commands, motors):
            print(service.__name__)
            service(station)
        print("air")
        # It falls at the end, and its program ends with it.
        air(station)
        vehicle.child.wait(20)
        station.close()
    print("signing")
    with Vehicle(speed=5) as vehicle:
        signing(vehicle)
    print("loss")
    loss()
    return 0


if __name__ == "__main__":
    sys.exit(main())
