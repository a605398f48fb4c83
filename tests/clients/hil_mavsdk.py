"""MAVSDK 4.1 and the flashed firmware on the emulated board: calibrations, missions/monitoring.plan by upload, the
flight to its end, the way home.

usage: hil_mavsdk.py
"""

import pathlib
import sys
import tempfile

from mavsdk.plugins.action import Action
from mavsdk.plugins.mission_raw import MissionRaw
from mavsdk.plugins.param import Param
from mavsdk.plugins.telemetry import FlightMode, LandedState, Telemetry

from hil import Board
from hil_monitoring import CALIBRATED, LONG
from mavsdk_flight import connect, raw, same
from sitl import expect, plan_items, wait_for


def fly(system, items):
    """From the ground to the ground."""
    action, telemetry, mission, param = Action(system), Telemetry(system), MissionRaw(system), Param(system)
    for name in CALIBRATED:
        param.set_param_float(name, 1.0)
    mission.upload_mission(items)
    back = mission.download_mission()
    expect(len(back) == len(items) and all(map(same, items, back)), "the mission comes back as it was sent")
    wait_for("all is well", lambda: telemetry.health_all_ok() and telemetry.health().is_armable, LONG)
    # In this order: arming goes to hold first.
    action.arm()
    mission.start_mission()
    wait_for("the mission flies", lambda: telemetry.flight_mode() == FlightMode.MISSION, LONG)
    wait_for("the mission's end", lambda: telemetry.flight_mode() == FlightMode.HOLD, LONG)
    progress = mission.mission_progress()
    expect(progress.total == len(items), f"{progress.current} of {progress.total} items")
    action.return_to_launch()
    wait_for("it has landed", lambda: telemetry.landed_state() == LandedState.ON_GROUND
             and not telemetry.armed(), LONG)
    print(f"  {progress.total} items flown, landed and disarmed")


def main():
    """All of it."""
    with tempfile.TemporaryDirectory(prefix="windhover-hil-") as folder:
        with Board(pathlib.Path(folder) / "board.flash") as board:
            mavsdk, system = connect(board.udp)
            fly(system, raw(plan_items()))
            mavsdk.destroy()
    return 0


if __name__ == "__main__":
    sys.exit(main())
