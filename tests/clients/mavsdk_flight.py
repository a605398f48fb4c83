"""MAVSDK 4.1: connect, parameters, missions, arm, fly, pause, return, offboard.

usage: mavsdk_flight.py
"""

import socket
import sys
import time

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.action import Action
from mavsdk.plugins.mission_raw import MissionItem, MissionRaw, MissionRawError
from mavsdk.plugins.offboard import Offboard, PositionNedYaw, VelocityNedYaw
from mavsdk.plugins.param import Param
from mavsdk.plugins.telemetry import FlightMode, LandedState, Telemetry

from sitl import Proxy, Vehicle, expect, free_port, many_items, plan_items, wait_for


def connect(port):
    """MAVSDK at a port, and the vehicle."""
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
    system = wait_for("a vehicle", lambda: mavsdk.first_autopilot(1.0), 20)
    return mavsdk, system


def raw(items):
    """Items as MAVSDK has them."""
    return [
        MissionItem(
            seq=seq, frame=frame, command=command, current=int(seq == 0), autocontinue=go_on,
            param1=p[0], param2=p[1], param3=p[2], param4=p[3], x=x, y=y, z=z, mission_type=0,
        )
        for seq, (frame, command, go_on, p, x, y, z) in enumerate(items)
    ]


def same(one, other):
    """Whether two items are equal, NaN and all."""
    def number(value):
        return "nan" if value != value else value
    fields = ("seq", "frame", "command", "autocontinue", "param1", "param2", "param3", "param4", "x", "y", "z")
    return all(number(getattr(one, field)) == number(getattr(other, field)) for field in fields)


def services(system):
    """Parameters and missions on a clean link."""
    param, mission = Param(system), MissionRaw(system)
    all_params = param.get_all_params()
    expect(len(all_params.float_params) > 150 and not all_params.int_params, "every parameter is a float")
    param.set_param_float("MIS_TAKEOFF_ALT", 12.0)
    expect(param.get_param_float("MIS_TAKEOFF_ALT") == 12.0, "a parameter is set")
    items = raw(many_items(250))
    begin = time.monotonic()
    mission.upload_mission(items)
    up = time.monotonic() - begin
    begin = time.monotonic()
    back = mission.download_mission()
    down = time.monotonic() - begin
    expect(len(back) == 250 and all(map(same, items, back)), "the mission comes back as it was sent")
    expect(up < 5 and down < 5, f"upload {up:.2f} s, download {down:.2f} s")
    print(f"  250 items: upload {up:.2f} s, download {down:.2f} s")


def flight(system):
    """Arm, take off, mission, pause, return."""
    action, telemetry, mission = Action(system), Telemetry(system), MissionRaw(system)
    wait_for("all is well", lambda: telemetry.health_all_ok(), 30)
    expect(telemetry.health().is_armable, "it can be armed")
    action.set_takeoff_altitude(15.0)
    action.arm()
    action.takeoff()
    wait_for("it hovers", lambda: telemetry.flight_mode() == FlightMode.HOLD
             and telemetry.position().relative_altitude_m > 14.0)
    mission.upload_mission(raw(plan_items()))
    mission.start_mission()
    wait_for("the mission flies", lambda: telemetry.flight_mode() == FlightMode.MISSION)
    wait_for("the third item", lambda: mission.mission_progress().current >= 3)
    mission.pause_mission()
    wait_for("it pauses", lambda: telemetry.flight_mode() == FlightMode.HOLD)
    mission.start_mission()
    wait_for("it goes on", lambda: mission.mission_progress().current >= 5)
    home = telemetry.home()
    latitude, longitude, altitude = home.latitude_deg, home.longitude_deg, home.absolute_altitude_m
    action.goto_location(latitude, longitude, altitude + 20, 0.0)
    wait_for("it is sent home", lambda: abs(telemetry.position().latitude_deg - latitude) < 5e-6)


def offboard(system):
    """Velocities and positions from outside."""
    telemetry, control = Telemetry(system), Offboard(system)
    def position():
        # The numbers, not what holds them: that is MAVSDK's, and gone with the next message.
        place = telemetry.position_velocity_ned().position
        return place.north_m, place.east_m, place.down_m

    # A plugin that is new has heard nothing yet: its numbers are none.
    north, east, down = wait_for("a position", lambda: position() if position()[0] == position()[0] else None)
    control.set_velocity_ned(VelocityNedYaw(1.0, 0.0, 0.0, 0.0))
    control.start()
    wait_for("offboard", lambda: telemetry.flight_mode() == FlightMode.OFFBOARD)
    wait_for("it moves north", lambda: position()[0] > north + 4)
    control.set_position_ned(PositionNedYaw(north, east + 6, down - 2, 90.0))
    wait_for("it is there", lambda: abs(position()[0] - north) < 0.5 and abs(position()[1] - east - 6) < 0.5)
    control.stop()
    wait_for("it holds", lambda: telemetry.flight_mode() == FlightMode.HOLD)


def landing(system):
    """Return and land; it disarms by itself."""
    action, telemetry = Action(system), Telemetry(system)
    action.return_to_launch()
    wait_for("it returns", lambda: telemetry.flight_mode() == FlightMode.RETURN_TO_LAUNCH)
    wait_for("it has landed", lambda: telemetry.landed_state() == LandedState.ON_GROUND
             and not telemetry.armed(), 120)


def lossy(loss, count, upload, download, seed):
    """Uploads or downloads at a network that loses; whether it came through."""
    with Vehicle(speed=1) as vehicle:
        port = free_port(socket.SOCK_DGRAM)
        items = raw(many_items(count))
        if not upload:
            mavsdk, system = connect(vehicle.udp)
            MissionRaw(system).upload_mission(items)
            mavsdk.destroy()
        proxy = Proxy(vehicle.udp, port, loss, seed=seed)
        mavsdk, system = connect(port)
        mission, came = MissionRaw(system), True
        try:
            if upload:
                mission.upload_mission(items)
            if download:
                back = mission.download_mission()
                came = len(back) == count and all(map(same, items, back))
        except MissionRawError as error:  # after its five tries
            came = False
            print(f"  seed {seed}: {error.result.name} in {error.origin}")
        mavsdk.destroy()
        proxy.close()
        return came


def main():
    """All of it."""
    print("services and flight")
    with Vehicle(speed=10) as vehicle:
        mavsdk, system = connect(vehicle.udp)
        services(system)
        flight(system)
        offboard(system)
        landing(system)
        mavsdk.destroy()
    print("upload of 250 items at 5 % loss, download of 20 at 10 %")
    ups = [lossy(0.05, 250, True, False, seed) for seed in range(1, 4)]
    downs = [lossy(0.10, 20, False, True, seed) for seed in range(1, 4)]
    print(f"  came through: {sum(ups)} of {len(ups)} uploads, {sum(downs)} of {len(downs)} downloads")
    # MAVSDK asks five times and sends its last item once: a lost last answer ends it.
    expect(any(ups) and any(downs), "none came through")
    return 0


if __name__ == "__main__":
    sys.exit(main())
