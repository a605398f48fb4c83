"""pymavlink uploads and downloads plans as it should, and as it should not: the stored one is never harmed.

usage: pymavlink_plans.py
"""

import struct
import sys

from sitl import Vehicle, expect, many_items, plan_items
from station import NAN, VEHICLE, Station, mav, same

ACCEPTED = mav.MAV_MISSION_ACCEPTED
CANCELLED = mav.MAV_MISSION_OPERATION_CANCELLED
MISSION, FENCE, RALLY = range(3)
LATITUDE, LONGITUDE = 473977418, 85455938

# A NaN that is not the usual one.
ODD_NAN = struct.unpack("<f", bytes.fromhex("4523c1ff"))[0]

# For so long after a transfer something of it may still come, s.
LEFT_OVER = 1.1

FENCES = [
    *(
        (0, mav.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, 1, [4.0, 0.0, 0.0, 0.0],
         LATITUDE + north, LONGITUDE + east, 0.0)
        for north, east in ((-9000, -9000), (-9000, 9000), (9000, 9000), (9000, -9000))
    ),
    (0, mav.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION, 1, [5.0, 0.0, 0.0, 0.0], LATITUDE + 8000, LONGITUDE, 0.0),
]
RALLIES = [
    (3, mav.MAV_CMD_NAV_RALLY_POINT, 1, [0.0] * 4, LATITUDE + 1000 * number, LONGITUDE, 15.0) for number in range(3)
]


def begin(station, items, upto, kind=MISSION):
    """Uploads the items before `upto`, which is asked for then."""
    station.drain(LEFT_OVER)
    station.send.mission_count_send(*VEHICLE, len(items), kind)
    for seq in range(upto + 1):
        station.find(f"request {seq}", "MISSION_REQUEST_INT", lambda asked: (asked.seq, asked.mission_type) == (seq, kind))
        if seq < upto:
            station.send_item(seq, items[seq], kind)


def ack(station, what):
    """How the vehicle ends a transfer."""
    return station.find(what, "MISSION_ACK", seconds=8).type


def stored(station, items, kind=MISSION):
    """What is stored is these items, bit for bit."""
    found = station.download(kind)
    expect(same(found, items), f"stored are {len(found)} items, not the {len(items)} that should be")


def ends(station, items):
    """An upload that is broken off, cancelled, or goes wrong leaves the stored mission as it is."""
    stored(station, items)
    other = plan_items()[:9]
    begin(station, other, 5)
    station.send.mission_ack_send(*VEHICLE, CANCELLED, MISSION)
    station.drain(0.1)
    asked = station.wait(("MISSION_REQUEST_INT", "MISSION_ACK"), seconds=0.6)
    expect(asked is None, f"after the cancel came {asked}")
    for seq, kind, wanted in (
        (7, MISSION, mav.MAV_MISSION_INVALID_SEQUENCE),
        (4, FENCE, mav.MAV_MISSION_INVALID),
    ):
        begin(station, other, 4)
        station.send_item(seq, other[seq], kind)
        result = ack(station, "the end of an upload with a wrong item")
        expect(result == wanted, f"item {seq} of kind {kind} where 4 was asked for: {result}, not {wanted}")
    begin(station, other, 5)
    station.send_item(2, other[2])
    answer = station.wait("MISSION_ACK", seconds=0.4)
    expect(answer is None, f"an old item, as networks repeat them, is answered with {answer}")
    result = ack(station, "the end of an upload that is broken off")
    expect(result == CANCELLED, f"an upload that is broken off ends with {result}")
    stored(station, items)
    # Begun anew in its middle.
    begin(station, other, 5)
    expect(station.upload(other) == ACCEPTED, "it can be begun anew")
    stored(station, other)


def refused(station):
    """What has no room or cannot be flown is refused with its reason."""
    items = station.download()
    station.send.mission_count_send(*VEHICLE, 60_000, MISSION)
    expect(ack(station, "60,000 items") == mav.MAV_MISSION_NO_SPACE, "60,000 items have no room")
    for item, wanted in (
        ((6, 31_000, 1, [0.0] * 4, LATITUDE, LONGITUDE, 10.0), mav.MAV_MISSION_UNSUPPORTED),
        ((20, 16, 1, [0.0] * 4, LATITUDE, LONGITUDE, 10.0), mav.MAV_MISSION_UNSUPPORTED_FRAME),
        ((6, 16, 1, [0.0] * 4, 1_000_000_000, LONGITUDE, 10.0), mav.MAV_MISSION_INVALID_PARAM5_X),
    ):
        wrong = [*items[:3], item, *items[3:]]
        result = station.upload(wrong)
        expect(result == wanted, f"{item}: {result}, not {wanted}; {station.texts[-2:]}")
    station.until_told("item 3")
    stored(station, items)


def kinds(station):
    """Mission, fence and rally points are kept, refused and cleared each for itself."""
    items = station.download()
    for kind, plan in ((FENCE, FENCES), (RALLY, RALLIES)):
        expect(station.upload(plan, kind) == ACCEPTED, f"kind {kind}: {station.texts[-3:]}")
        stored(station, plan, kind)
    three = [(frame, command, go_on, [3.0, 0.0, 0.0, 0.0], *place) for frame, command, go_on, _, *place in FENCES[:4]]
    expect(station.upload(three, FENCE) != ACCEPTED, "four corners that say three are a fence")
    stored(station, FENCES, FENCE)
    station.send.mission_clear_all_send(*VEHICLE, FENCE)
    expect(ack(station, "cleared") == ACCEPTED, "the fence is cleared")
    for kind, plan in ((FENCE, []), (RALLY, RALLIES), (MISSION, items)):
        stored(station, plan, kind)
    station.drain()
    station.send.mission_clear_all_send(*VEHICLE, mav.MAV_MISSION_TYPE_ALL)
    expect(ack(station, "all cleared") == ACCEPTED, "all are cleared")
    for kind in (MISSION, FENCE, RALLY):
        stored(station, [], kind)
    station.send.mission_request_list_send(*VEHICLE, 9)
    expect(ack(station, "kind 9") == mav.MAV_MISSION_UNSUPPORTED, "there is no kind 9")


def last_again(station):
    """Who has not heard the end sends the last item again, and hears it again."""
    items = plan_items()[:7]
    expect(station.upload(items) == ACCEPTED, "the upload")
    station.drain(0.3)
    station.send_item(6, items[6])
    expect(ack(station, "the last item again") == ACCEPTED, "it is accepted again")
    station.drain(LEFT_OVER)
    station.send.mission_request_int_send(*VEHICLE, 7, MISSION)
    expect(ack(station, "an item beyond the end") == mav.MAV_MISSION_INVALID_SEQUENCE, "there is no item 7")


def elsewhere(station):
    """What is for another vehicle, or another component, is not answered."""
    station.drain(LEFT_OVER)
    station.send.mission_count_send(2, 1, 5, MISSION)
    station.send.mission_request_list_send(1, 77, MISSION)
    answer = station.wait(("MISSION_REQUEST_INT", "MISSION_COUNT", "MISSION_ACK"), seconds=0.5)
    expect(answer is None, f"answered with {answer}")


def several(station, others):
    """While one station uploads, others read the stored mission, and may not upload."""
    before, items = station.download(), plan_items()[:12]
    begin(station, items, 6)
    for other in others:
        result = other.upload(items[:3])
        expect(result == mav.MAV_MISSION_DENIED, f"another upload beside it: {result}")
        stored(other, before)
    for seq in range(6, 12):
        station.send_item(seq, items[seq])
        if seq < 11:
            station.find(f"request {seq + 1}", "MISSION_REQUEST_INT", lambda asked: asked.seq == seq + 1)
    expect(ack(station, "the end of the upload") == ACCEPTED, "it goes on all the same")
    for one in (station, *others):
        stored(one, items)


def with_floats(station):
    """A client that knows no integers sends MISSION_ITEM, and reads by MISSION_REQUEST."""
    station.drain(LEFT_OVER)
    station.send.mission_count_send(*VEHICLE, 2, MISSION)
    for seq, (command, height) in enumerate(((22, 20.0), (16, 25.0))):
        station.find(f"request {seq}", "MISSION_REQUEST_INT", lambda asked: asked.seq == seq)
        fields = (3, command, 0, 1, 0, 0, 0, NAN, LATITUDE * 1e-7, LONGITUDE * 1e-7, height)
        station.send.mission_item_send(*VEHICLE, seq, *fields, MISSION)
    expect(ack(station, "the end") == ACCEPTED, f"items with floats: {station.texts[-2:]}")
    station.send.mission_request_send(*VEHICLE, 1, MISSION)
    item = station.find("item 1", "MISSION_ITEM_INT")
    # A float has its places 4e-6 degrees apart.
    near = abs(item.x - LATITUDE) < 40 and abs(item.y - LONGITUDE) < 10
    expect((item.seq, item.command, item.z) == (1, 16, 25.0) and near, f"it comes back as {item}")


def main():
    """All of it."""
    with Vehicle(speed=5) as vehicle:
        station = Station(f"udpin:127.0.0.1:{vehicle.udp}")
        station.ready()
        items = many_items(250)
        items[4] = (*items[4][:3], [0.0, 1.0, 0.0, ODD_NAN], *items[4][4:])
        expect(station.upload(items) == ACCEPTED, f"250 items: {station.texts}")
        # One beside it at the same socket of the vehicle, and one by TCP.
        ((host, port),) = station.link.clients
        others = [
            Station(f"udpout:{host}:{port}", system=253),
            Station(f"tcp:127.0.0.1:{vehicle.tcp}", system=254),
        ]
        ends(station, items)
        for check in (refused, kinds, last_again, elsewhere):
            print(check.__name__)
            check(station)
        several(station, others)
        with_floats(station)
    return 0


if __name__ == "__main__":
    sys.exit(main())
