"""pymavlink flies by commands, setpoints, sticks and channels; each command is answered once.

usage: pymavlink_flight.py
"""

import math
import sys
from functools import partial

from sitl import Vehicle, expect
from station import ARM, NAN, VEHICLE, Station, mav

ACCEPTED = mav.MAV_RESULT_ACCEPTED
REJECTED = mav.MAV_RESULT_TEMPORARILY_REJECTED
DENIED = mav.MAV_RESULT_DENIED
FORCE = 21196

# PX4's modes: main, sub.
POSITION, OFFBOARD = (3, 0), (6, 0)
TAKEOFF, HOLD, MISSION, RETURN, LAND = (4, 2), (4, 3), (4, 4), (4, 5), (4, 6)

# Bits of type_mask, each for what is to be ignored.
PLACE, VELOCITY, ACCELERATION, HEADING, RATE = 7, 7 << 3, 7 << 6, 1 << 10, 1 << 11


def refuses(station, wanted, what, command, *params, **how):
    """A command that is not accepted, with this result."""
    result = station.result(command, *params, **how)
    expect(result == wanted, f"{what}: {result}, not {wanted}; {station.texts[-3:]}")


def on_the_ground(station):
    """Blockers are named, force heeds none; what needs sticks, setpoints or a flight is refused."""
    known = station.parameter("CAL_GYRO0_ID")
    station.parameter("CAL_GYRO0_ID", 0.0)
    station.drain(0.1)
    refuses(station, REJECTED, "arming with no calibration", ARM, 1)
    station.until_told("Arming refused: gyro not calibrated")
    station.order(ARM, 1, FORCE)
    station.until("armed by force", lambda: station.armed, 5)
    station.order(ARM, 0)
    station.until("disarmed", lambda: not station.armed, 5)
    station.parameter("CAL_GYRO0_ID", known)
    station.ready()
    refuses(station, DENIED, "arming with a number that means nothing", ARM, 7)
    for mode, words in ((OFFBOARD, "no setpoints"), (POSITION, "no sticks")):
        expect(station.set_mode(*mode) == REJECTED, f"mode {mode} without any: {station.texts[-2:]}")
        station.until_told(words)
    expect(station.set_mode(4, 9) == DENIED, "there is no such mode")
    silent = station.send.command_long_send(2, 1, ARM, 0, 1, 0, 0, 0, 0, 0, 0)
    expect(silent is None and station.wait("COMMAND_ACK", seconds=0.3) is None, "what is for others is not answered")


def home(station):
    """Home is set to a place, and back to here; HOME_POSITION says so."""
    latitude, longitude, altitude = station.home()
    place = partial(station.result, mav.MAV_CMD_DO_SET_HOME, 0, 0, 0, 0, integers=True)
    expect(place(latitude + 500, longitude, altitude) == ACCEPTED, "home there")
    station.find("home there", "HOME_POSITION", lambda told: abs(told.latitude - latitude - 500) <= 2)
    expect(place(2_000_000_000, longitude, altitude) == DENIED, "that is no place")
    station.order(mav.MAV_CMD_DO_SET_HOME, 1)
    station.find("home here", "HOME_POSITION", lambda told: abs(told.latitude - latitude) < 200)


def climb(station, height):
    """Arms and takes off."""
    station.ready()
    station.order(ARM, 1)
    station.order(mav.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, NAN, NAN, NAN, station.home()[2] + height)
    station.until_mode(TAKEOFF)
    station.until_near("takeoff", (0, 0, -height))
    station.until_mode(HOLD)
    refuses(station, REJECTED, "disarming in flight", ARM, 0)
    refuses(station, REJECTED, "a motor test in flight", mav.MAV_CMD_DO_MOTOR_TEST, 1, 0, 10, 1)


def go(station):
    """To places and altitudes, as MAVSDK and QGroundControl ask for them; a pause on the way."""
    def to(north, height, speed=-1.0, frame=5):
        place = station.place(north, 0, height)
        return station.result(mav.MAV_CMD_DO_REPOSITION, speed, 1, 0, NAN, *place, integers=True, frame=frame)

    expect(to(25, 12, speed=5.0) == ACCEPTED, f"go there: {station.texts[-2:]}")
    station.find("more than 3.5 m/s of 5", "VFR_HUD", lambda told: told.groundspeed > 3.5)
    station.until_near("there", (25, 0, -12))
    station.order(mav.MAV_CMD_DO_REPOSITION, -1, 1, 0, NAN, NAN, NAN, station.home()[2] + 15)
    station.until_near("higher", (25, 0, -15))
    station.order(mav.MAV_CMD_DO_CHANGE_ALTITUDE, 12, mav.MAV_FRAME_GLOBAL_RELATIVE_ALT)
    station.until_near("lower", (25, 0, -12))
    expect(to(0, 12, frame=0) == ACCEPTED, f"go back: {station.texts[-2:]}")
    station.find("on the way", "LOCAL_POSITION_NED", lambda at: at.x < 20)
    station.order(mav.MAV_CMD_DO_REPOSITION, -1, 1, 0, NAN, NAN, NAN, NAN)
    station.find("at rest", "LOCAL_POSITION_NED", lambda at: math.hypot(at.vx, at.vy) < 0.3)
    expect(station.local()[0] > 5.0, f"it did not pause, but went on to {station.local()}")
    expect(to(1e6, 12) == DENIED, "too far")


def photos(station):
    """One photo, and three a second apart by the vehicle's clock, each told with its place."""
    station.photos.clear()
    station.order(mav.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1)
    station.until("one photo", lambda: len(station.photos) == 1, 5)
    station.order(mav.MAV_CMD_IMAGE_START_CAPTURE, 0, 1, 3)
    station.until("three more", lambda: len(station.photos) == 4, 10)
    station.drain(0.5)
    numbers = [photo.image_index for photo in station.photos]
    expect(numbers == list(range(numbers[0], numbers[0] + 4)), f"photos {numbers}")
    times = [photo.time_boot_ms for photo in station.photos[1:]]
    apart = [after - before for before, after in zip(times, times[1:])]
    expect(all(abs(time - 1000) < 50 for time in apart), f"a second apart: {apart}")
    latitude = station.place(station.local()[0], 0, 0)[0]
    expect(all(abs(photo.lat - latitude) < 300 for photo in station.photos), "taken here")


def mission(station):
    """Starts, flies faster, looks aside, is not exchanged meanwhile, pauses, goes on with another item."""
    items = []
    for north in (15, 80, 100, 0):
        latitude, longitude, _ = station.place(north, 0, 0)
        items.append((6, mav.MAV_CMD_NAV_WAYPOINT, 1, [0.0, 1.0, 0.0, NAN], latitude, longitude, 12.0))
    expect(station.upload(items) == mav.MAV_MISSION_ACCEPTED, f"the mission: {station.texts[-2:]}")
    station.order(mav.MAV_CMD_MISSION_START, 0, 0)
    station.until_mode(MISSION)
    expect(station.upload(items[:2]) == mav.MAV_MISSION_DENIED, "it is not exchanged while it is flown")
    station.order(mav.MAV_CMD_DO_CHANGE_SPEED, 1, 6, -1)
    station.find("more than 4 m/s of 6", "VFR_HUD", lambda told: told.groundspeed > 4)
    station.order(mav.MAV_CMD_DO_PAUSE_CONTINUE, 0)
    station.until_mode(HOLD)
    def progress(state, seq=None):
        return lambda told: told.mission_state == state and seq in (None, told.seq)

    station.find("paused", "MISSION_CURRENT", progress(mav.MISSION_STATE_PAUSED))
    station.order(mav.MAV_CMD_DO_PAUSE_CONTINUE, 1)
    station.until_mode(MISSION)
    aside = station.place(50, 3000, 0)
    look = station.result(mav.MAV_CMD_DO_SET_ROI_LOCATION, 0, 0, 0, 0, *aside, integers=True)
    expect(look == ACCEPTED, f"look aside: {look}")
    station.find("heading to the east", "ATTITUDE", lambda told: abs(told.yaw - math.pi / 2) < 0.15)
    station.order(mav.MAV_CMD_DO_SET_ROI_NONE)
    station.send.mission_set_current_send(*VEHICLE, 3)
    station.find("item 3 is current", "MISSION_CURRENT", progress(mav.MISSION_STATE_ACTIVE, 3))
    station.find("item 3 is reached", "MISSION_ITEM_REACHED", lambda told: told.seq == 3)
    station.find("complete", "MISSION_CURRENT", progress(mav.MISSION_STATE_COMPLETE))
    expect(station.result(mav.MAV_CMD_MISSION_START, 9, 0) == REJECTED, "there is no item 9")


def offboard(station):
    """Places and velocities are followed for as long as they come."""
    beyond = ACCELERATION | HEADING | RATE
    local = partial(station.send.set_position_target_local_ned_send, 0, *VEHICLE)
    degrees = partial(station.send.set_position_target_global_int_send, 0, *VEHICLE)
    zeros = [0.0] * 8

    def place():
        local(mav.MAV_FRAME_LOCAL_NED, VELOCITY | beyond, 6.0, 4.0, -8.0, *zeros)

    begin(station, place, OFFBOARD)
    station.until_near("at the setpoint", (6, 4, -8), send=place)
    east = [0.0, 0.0, 0.0, 0.0, 1.5, -0.5, *zeros[:5]]
    by_velocity = partial(local, mav.MAV_FRAME_LOCAL_NED, PLACE | beyond, *east)
    station.until_near("east by velocity", (None, 15, None), send=by_velocity)
    forward = partial(local, mav.MAV_FRAME_BODY_NED, PLACE | beyond, 0.0, 0.0, 0.0, 1.0, *zeros[:7])
    station.until_near("ahead by velocity", aim(station, 8, 0), within=1.5, send=forward)
    latitude, longitude, _ = station.home()
    above = partial(degrees, 6, VELOCITY | beyond, latitude, longitude, 9.0, *zeros)
    station.until_near("at home by degrees", (0, 0, -9), send=above)
    expect(station.mode == OFFBOARD, f"mode {station.mode}")
    # No more of them.
    station.until_mode(HOLD)
    station.until_told("setpoints from outside lost")


def begin(station, send, mode):
    """A mode that needs something that keeps coming: first that, then the mode."""
    for _ in range(5):
        send()
        station.drain(0.02)
    expect(station.set_mode(*mode) == ACCEPTED, f"mode {mode}: {station.texts[-3:]}")
    send()
    station.until_mode(mode)


def aim(station, ahead, right):
    """A place so many m ahead and to the right of the vehicle."""
    yaw = station.find("an attitude", "ATTITUDE").yaw
    north, east, _ = station.local()
    forward, aside = (math.cos(yaw), math.sin(yaw)), (-math.sin(yaw), math.cos(yaw))
    return north + ahead * forward[0] + right * aside[0], east + ahead * forward[1] + right * aside[1], None


def by_hand(station):
    """MANUAL_CONTROL and RC_CHANNELS_OVERRIDE fly; without them it returns, lands and disarms."""
    def pad(forward):
        station.send.manual_control_send(VEHICLE[0], forward, 0, 500, 0, 0)

    begin(station, partial(pad, 0), POSITION)
    station.until_near("ahead by a stick", aim(station, 6, 0), within=1.5, send=partial(pad, 500))
    station.order(mav.MAV_CMD_DO_PAUSE_CONTINUE, 0)
    station.until_mode(HOLD)

    def channels(roll):
        station.send.rc_channels_override_send(*VEHICLE, roll, 1500, 1500, 1500, 2000, 1000, 65_535, 65_535)

    begin(station, partial(channels, 1500), POSITION)
    station.until_near("to the right by channel 1", aim(station, 0, 6), within=1.5, send=partial(channels, 1800))
    station.until_mode(RETURN)
    station.until_told("remote control lost")
    station.until("landed and disarmed", lambda: not station.armed)
    north, east, _ = station.local()
    expect(math.hypot(north, east) < 3.0, f"landed {north:.1f}, {east:.1f} m from home")


def kill(station, vehicle):
    """Landing by its command; then a kill in the air, after which it falls, and its program ends."""
    climb(station, 5)
    station.order(mav.MAV_CMD_NAV_LAND)
    station.until_mode(LAND)
    station.until("landed and disarmed", lambda: not station.armed)
    climb(station, 15)
    station.order(ARM, 0, FORCE)
    vehicle.child.wait(20)
    expect(any("Motors killed" in line for line in vehicle.lines), "a line says that the motors were killed")


def main():
    """All of it."""
    with Vehicle(speed=10) as vehicle:
        station = Station(f"udpin:127.0.0.1:{vehicle.udp}")
        station.ready()
        for check in (on_the_ground, home):
            print(check.__name__)
            check(station)
        climb(station, 10)
        for check in (go, photos, mission, offboard, by_hand):
            print(check.__name__)
            check(station)
        station.answered_once()
    # A remote control that was lost speaks against arming.
    print("kill")
    with Vehicle(speed=10) as vehicle:
        kill(Station(f"udpin:127.0.0.1:{vehicle.udp}"), vehicle)
    return 0


if __name__ == "__main__":
    sys.exit(main())
