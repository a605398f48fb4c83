"""The flashed firmware on the emulated board, for clients: started on ports of its own, and stopped."""

import os

from sitl import ROOT, Vehicle, expect

FIRMWARE = ROOT / "target" / "thumbv7em-none-eabihf" / "firmware" / "windhover-firmware"


def program():
    """The program, as WINDHOVER_HIL names it, or as a release build leaves it."""
    return os.environ.get("WINDHOVER_HIL", str(ROOT / "target" / "release" / "windhover-hil"))


class Board(Vehicle):
    """`windhover-hil` as a child, as fast as it goes; its flash is kept in a file.

    By the clock it may be faster or slower than a vehicle: nothing here measures by the clock.
    """

    greeting = "windhover-hil:"
    # It replays its log before it ends.
    patience = 600

    def __init__(self, flash, options=()):
        super().__init__(speed=0, options=options)
        self.flash = flash

    def command(self):
        elf = os.environ.get("WINDHOVER_ELF", str(FIRMWARE))
        return [program(), "--elf", elf, "--flash", str(self.flash), "--out", str(self.log)]

    def replay(self):
        """It has said of its log that the replay is equal, besides the exit code."""
        line = next((line for line in self.lines if line.startswith("replay ")), "no replay")
        expect(line.split()[1] == "equal,", line)
        print(f"  {line}")
