"""Upload of missions/monitoring.plan, then the flight, then ten photos reported.

usage: pymavlink_monitoring.py
"""

import sys

from sitl import Vehicle, expect, plan_items
from station import ARM, Station, mav


def main():
    """All of it."""
    with Vehicle(speed=20) as vehicle:
        station = Station(f"udpin:127.0.0.1:{vehicle.udp}")
        station.ready()
        expect(station.upload(plan_items()) == mav.MAV_MISSION_ACCEPTED, f"the mission: {station.texts}")
        expect(station.set_mode(4, 4) == mav.MAV_RESULT_ACCEPTED, f"mode mission: {station.texts}")
        station.order(ARM, 1)
        station.until("ten photos", lambda: len(station.photos) >= 10, 120)
        station.until("hold at the end", lambda: station.mode == (4, 3))
        station.order(mav.MAV_CMD_NAV_RETURN_TO_LAUNCH)
        station.until("landed and disarmed", lambda: not station.armed, 60)
        expect([photo.image_index for photo in station.photos] == list(range(10)), "each photo once")
        places = {(photo.lat, photo.lon) for photo in station.photos}
        expect(len(places) == 10, f"ten places: {places}")
        heights = [photo.relative_alt / 1000 for photo in station.photos]
        expect(all(abs(height - 30) < 1 for height in heights), f"30 m high: {heights}")
        station.close()
        print(f"  ten photos at {min(heights):.2f} to {max(heights):.2f} m; items reached: {station.reached}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
