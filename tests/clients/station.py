"""A ground station on pymavlink: the services as a client without habits of its own uses them."""

import math
import os
import struct
import time
from collections import Counter

# pymavlink speaks MAVLink 1, which has no kinds of plans, unless told so before it is loaded.
os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil  # noqa: E402
from pymavlink.dialects.v20 import common as mav  # noqa: E402

from sitl import expect  # noqa: E402

ARM = mav.MAV_CMD_COMPONENT_ARM_DISARM
VEHICLE = (1, 1)


def bits(value):
    """A float by its bits, so that NaN can be compared."""
    return struct.pack("<f", value)


class Station:
    """One client of one vehicle."""

    def __init__(self, address, system=255, beat=1.0):
        """At pymavlink's `address`; `system` is its own number, `beat` s are between its heartbeats."""
        self.beats_every = beat
        self.link = mavutil.mavlink_connection(
            address, source_system=system, source_component=190, autoreconnect=False
        )
        self.send = self.link.mav
        self.texts = []
        self.photos = []
        self.reached = []
        self.heartbeat = None
        self.sent, self.answered = Counter(), Counter()
        self.slowest = 0.0
        self.beat = 0.0
        # By udpout it is heard first, and hears then.
        self.until("a heartbeat comes", lambda: self.heartbeat is not None, 20)

    def close(self):
        """Goes away."""
        self.link.close()

    def look(self, timeout=0.05):
        """The next message, if one comes; what is to be told on the way is noted."""
        if time.monotonic() - self.beat > self.beats_every:
            self.beat = time.monotonic()
            self.send.heartbeat_send(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        message = self.link.recv_match(blocking=True, timeout=timeout)
        if message is None or message.get_srcSystem() != VEHICLE[0]:
            return None
        # What is told to another station comes by the same socket.
        if getattr(message, "target_system", 0) not in (0, self.link.source_system):
            return None
        kind = message.get_type()
        if kind == "STATUSTEXT":
            # What is long comes in chunks.
            if getattr(message, "chunk_seq", 0) > 0 and self.texts:
                self.texts[-1] += message.text
            else:
                self.texts.append(message.text)
        elif kind == "CAMERA_IMAGE_CAPTURED":
            self.photos.append(message)
        elif kind == "MISSION_ITEM_REACHED":
            self.reached.append(message.seq)
        elif kind == "HEARTBEAT":
            self.heartbeat = message
        elif kind == "COMMAND_ACK" and message.result != mav.MAV_RESULT_IN_PROGRESS:
            self.answered[message.command] += 1
        return message

    def wait(self, kinds, fits=lambda message: True, seconds=5.0):
        """The next message of these kinds that fits, or None."""
        kinds = {kinds} if isinstance(kinds, str) else set(kinds)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = self.look()
            if message is not None and message.get_type() in kinds and fits(message):
                return message
        return None

    def find(self, what, kinds, fits=lambda message: True, seconds=20.0):
        """The next message of these kinds that fits, which must come."""
        message = self.wait(kinds, fits, seconds)
        expect(message is not None, f"not within {seconds} s: {what}; texts: {self.texts[-6:]}")
        return message

    def drain(self, seconds=0.0):
        """Takes in what has come, and what comes for so long."""
        end = time.monotonic() + seconds
        while self.look(0.001) is not None or time.monotonic() < end:
            pass

    def said(self, words):
        """Whether a line of text has these words."""
        return any(words in text for text in self.texts)

    def until(self, what, holds, seconds=60.0):
        """Looks until something holds."""
        end = time.monotonic() + seconds
        while not holds():
            expect(time.monotonic() < end, f"not within {seconds} s: {what}; texts: {self.texts[-12:]}")
            self.look()

    def until_mode(self, mode, seconds=60.0):
        """Looks until the mode is this one."""
        self.until(f"mode {mode}", lambda: self.mode == mode, seconds)

    def until_told(self, words, seconds=5.0):
        """Looks until a line of text with these words has come."""
        self.until(f"a text: {words}", lambda: self.said(words), seconds)

    def until_near(self, what, place, within=1.0, seconds=40.0, send=lambda: None):
        """Looks until the vehicle is near a place, m north, east and down from home; `None` is anywhere.

        `send` is called again and again until then.
        """
        at, end = None, time.monotonic() + seconds
        while time.monotonic() < end:
            send()
            message = self.look(0.02)
            if message is None or message.get_type() != "LOCAL_POSITION_NED":
                continue
            at = (message.x, message.y, message.z)
            if all(want is None or abs(found - want) < within for found, want in zip(at, place)):
                return
        expect(False, f"{what}: not near {place} but at {at}, mode {self.mode}; texts: {self.texts[-6:]}")

    @property
    def armed(self):
        """Whether the motors may turn."""
        return self.heartbeat is not None and bool(self.heartbeat.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def mode(self):
        """PX4's main and sub mode."""
        custom = self.heartbeat.custom_mode if self.heartbeat is not None else 0
        return custom >> 16 & 0xFF, custom >> 24

    def command(self, command, *params, integers=False, frame=0):
        """Sends a command once; its result, and how long the first answer took."""
        params = list(params) + [0.0] * (7 - len(params))
        self.drain()
        self.sent[command] += 1
        begin = time.monotonic()
        if integers:
            x, y = (int(value) for value in params[4:6])
            self.send.command_int_send(*VEHICLE, frame, command, 0, 0, *params[:4], x, y, params[6])
        else:
            self.send.command_long_send(*VEHICLE, command, 0, *params)
        answer = self.wait("COMMAND_ACK", lambda ack: ack.command == command)
        took = time.monotonic() - begin
        self.slowest = max(self.slowest, took)
        while answer is not None and answer.result == mav.MAV_RESULT_IN_PROGRESS:
            answer = self.wait("COMMAND_ACK", lambda ack: ack.command == command)
        expect(answer is not None, f"command {command} is answered")
        return answer.result, took

    def result(self, command, *params, **how):
        """Sends a command once; its result."""
        return self.command(command, *params, **how)[0]

    def answered_once(self):
        """Every command was answered once, and soon: within 100 ms of the vehicle's, on a busy machine 500."""
        self.drain(0.3)
        expect(self.answered == self.sent, f"sent {self.sent}, answered {self.answered}")
        print(f"  {sum(self.sent.values())} commands, slowest answer {self.slowest * 1000:.1f} ms")
        expect(self.slowest < 0.5, "the slowest answer took too long")

    def order(self, command, *params):
        """A command that is to be accepted."""
        result, _ = self.command(command, *params)
        expect(result == mav.MAV_RESULT_ACCEPTED, f"command {command}: {result}; {self.texts[-6:]}")

    def set_mode(self, main, sub=0):
        """Asks for one of PX4's modes; the result."""
        return self.command(mav.MAV_CMD_DO_SET_MODE, 1, main, sub)[0]

    def ready(self):
        """Waits until it can be armed."""
        bit = mav.MAV_SYS_STATUS_PREARM_CHECK
        healthy = self.wait("SYS_STATUS", lambda status: status.onboard_control_sensors_health & bit, 60)
        expect(healthy is not None, "it can be armed")

    def home(self):
        """Where home is: 1e-7 degrees, and m above the sea."""
        self.order(mav.MAV_CMD_REQUEST_MESSAGE, mav.MAVLINK_MSG_ID_HOME_POSITION)
        home = self.find("home", "HOME_POSITION")
        return home.latitude, home.longitude, home.altitude * 1e-3

    def place(self, north, east, height):
        """A place so many m from home, as parameters 5 to 7 of a command with integers, m above the sea."""
        latitude, longitude, altitude = self.home()
        per_metre = 89.83
        shrunk = per_metre / math.cos(math.radians(latitude * 1e-7))
        return latitude + round(north * per_metre), longitude + round(east * shrunk), altitude + height

    def local(self):
        """North, east and down from home, m."""
        self.drain()
        at = self.find("a position", "LOCAL_POSITION_NED")
        return at.x, at.y, at.z

    def parameter(self, name, value=None):
        """Reads a parameter by its name, or sets it; what the vehicle then has."""
        if value is None:
            self.send.param_request_read_send(*VEHICLE, name.encode(), -1)
        else:
            self.send.param_set_send(*VEHICLE, name.encode(), value, mav.MAV_PARAM_TYPE_REAL32)
        answer = self.wait("PARAM_VALUE", lambda found: found.param_id == name, 2)
        return None if answer is None else answer.param_value

    def upload(self, items, kind=0, patience=1.0, tries=50):
        """Uploads: what is asked for is sent; begins anew when nothing comes. The result."""
        for _ in range(tries):
            self.send.mission_count_send(*VEHICLE, len(items), kind)
            while True:
                message = self.wait(
                    ("MISSION_REQUEST_INT", "MISSION_REQUEST", "MISSION_ACK"),
                    lambda found: found.mission_type == kind,
                    patience,
                )
                if message is None:
                    break
                if message.get_type() == "MISSION_ACK":
                    return message.type
                self.send_item(message.seq, items[message.seq], kind)
        return None

    def send_item(self, seq, item, kind=0):
        """One item."""
        frame, command, go_on, params, x, y, z = item
        self.send.mission_item_int_send(*VEHICLE, seq, frame, command, 0, go_on, *params, x, y, z, kind)

    def download(self, kind=0, patience=0.3, tries=100):
        """Downloads, each item until it comes."""
        count = None
        for _ in range(tries):
            self.send.mission_request_list_send(*VEHICLE, kind)
            count = self.wait("MISSION_COUNT", lambda found: found.mission_type == kind, patience)
            if count is not None:
                break
        expect(count is not None, "a count comes")
        items = []
        for seq in range(count.count):
            for _ in range(tries):
                self.send.mission_request_int_send(*VEHICLE, seq, kind)
                found = self.wait(
                    "MISSION_ITEM_INT", lambda item: item.seq == seq and item.mission_type == kind, patience
                )
                if found is not None:
                    break
            expect(found is not None, f"item {seq} comes")
            params = [found.param1, found.param2, found.param3, found.param4]
            items.append((found.frame, found.command, found.autocontinue, params, found.x, found.y, found.z))
        self.send.mission_ack_send(*VEHICLE, mav.MAV_MISSION_ACCEPTED, kind)
        return items


def same(one, other):
    """Whether two lists of items are equal, bit for bit."""
    def plain(item):
        frame, command, go_on, params, x, y, z = item
        return frame, command, go_on, [bits(value) for value in params], x, y, bits(z)
    return [plain(item) for item in one] == [plain(item) for item in other]


NAN = math.nan
__all__ = ["ARM", "NAN", "Station", "VEHICLE", "bits", "mav", "same"]
