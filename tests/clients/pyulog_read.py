"""Reads logs with pyulog and holds it against a count of its own.

usage: pyulog_read.py LOG...

Each log's messages are counted by walking through the file; then pyulog has to find every topic
that has data, with as many messages and the fields of its format, every parameter and every
string, and no corruption. Exits with 1 otherwise.
"""

import struct
import sys
from collections import Counter

import numpy
from pyulog import ULog


def walk(path):
    """Names of the topics with data and their counts, and the parameters, straight from the file."""
    with open(path, "rb") as file:
        data = file.read()
    names, counts, parameters = {}, Counter(), {}
    at = 16
    while at + 3 <= len(data):
        size, kind = struct.unpack_from("<HB", data, at)
        body = data[at + 3 : at + 3 + size]
        if len(body) < size:
            break
        at += 3 + size
        if kind == ord("A"):
            names[struct.unpack_from("<H", body, 1)[0]] = body[3:].decode()
        elif kind == ord("D"):
            counts[struct.unpack_from("<H", body)[0]] += 1
        elif kind == ord("P"):
            length = body[0]
            name = body[1 : 1 + length].decode().split(" ")[1]
            parameters[name] = struct.unpack_from("<f", body, 1 + length)[0]
    return {names[number]: count for number, count in counts.items()}, parameters


def check(path):
    """Reads one log; the complaints."""
    expected, parameters = walk(path)
    log = ULog(path, disable_str_exceptions=False)
    complaints = []
    if log.file_corruption:
        complaints.append("pyulog finds it corrupt")
    found = {data.name: len(data.data["timestamp"]) for data in log.data_list}
    if found != expected:
        complaints.append(f"topics: pyulog has {found}, the file has {expected}")
    for data in log.data_list:
        times = data.data["timestamp"]
        if numpy.any(times[1:] < times[:-1]):
            complaints.append(f"{data.name}: times go back")
        for name, values in data.data.items():
            if len(values) != len(times):
                complaints.append(f"{data.name}.{name}: {len(values)} values for {len(times)} times")
    if log.initial_parameters != parameters or not parameters:
        complaints.append("parameters differ")
    if log.msg_info_dict.get("sys_name") != "Windhover":
        complaints.append("sys_name is not Windhover")
    counts = ", ".join(f"{name} {count}" for name, count in sorted(found.items()))
    print(f"{path}: {len(found)} topics, {len(parameters)} parameters, {len(log.dropouts)} dropouts: {counts}")
    return complaints


def main(paths):
    """Reads all logs."""
    if not paths:
        print(__doc__)
        return 2
    bad = 0
    for path in paths:
        for complaint in check(path):
            print(f"{path}: {complaint}", file=sys.stderr)
            bad = 1
    return bad


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
