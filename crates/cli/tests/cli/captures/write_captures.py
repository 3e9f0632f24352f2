"""Writes the captures beside this file: python3 write_captures.py (needs scapy 2.8, and mergecap of Wireshark).

All captures hold one drive, which the tests know too: for 6 s a robot drives along y = 2 m at 0.5 m/s from x = 0. In second k,
node n is heard at 0.25 s and 0.75 s with a level of -50 - 5 n - k dBm: node 0 in each second, node 1 in seconds 1 to 4, node
2 in second 2. Each frame of node 1 is acknowledged by somebody, 1 ms later.
"""

import struct
import subprocess
from pathlib import Path

from scapy.layers.dot11 import Dot11, Dot11Beacon, Dot11Elt, RadioTap
from scapy.layers.dot15d4 import Dot15d4, Dot15d4AuxSecurityHeader, Dot15d4Data, Dot15d4FCS
from scapy.packet import Raw
from scapy.utils import PcapWriter

HERE = Path(__file__).parent
START_NS = 1_700_000_000_123_456_000
SECOND_NS = 1_000_000_000
HEARD = [range(6), range(1, 5), [2]]
TAP, WITH_FCS, WITHOUT_FCS, RADIOTAP = 283, 195, 230, 127


def packets():
    """Time, node, level, in the order of time."""
    found = []
    for node, seconds in enumerate(HEARD):
        for second in seconds:
            for fraction in (0.25, 0.75):
                ns = START_NS + second * SECOND_NS + int(fraction * SECOND_NS) + 5_000_000 * node
                found.append((ns, node, -50 - 5 * node - second))
    return sorted(found)


def mac_frame(node, index):
    """A frame of IEEE 802.15.4 without FCS. Each node has other addresses, versions and modes."""
    sequence = index % 256
    if node == 0:
        secured = index % 2
        head = Dot15d4(
            fcf_frametype=1, fcf_panidcompress=1, fcf_destaddrmode=2, fcf_srcaddrmode=2, fcf_framever=1,
            fcf_security=secured, seqnum=sequence,
        )
        data = Dot15d4Data(dest_panid=0xABCD, dest_addr=0, src_addr=1)
        if secured:
            data.aux_sec_header = Dot15d4AuxSecurityHeader(
                sec_sc_seclevel=5, sec_sc_keyidmode=1, sec_framecounter=index, sec_keyid_keyindex=1
            )
        return bytes(head / data / Raw(b"\x00payload"))
    if node == 1:
        head = Dot15d4(
            fcf_frametype=1, fcf_panidcompress=1, fcf_ackreq=1, fcf_destaddrmode=2, fcf_srcaddrmode=3, seqnum=sequence
        )
        data = Dot15d4Data(dest_panid=0xABCD, dest_addr=0, src_addr=0x00124B0001020304)
        return bytes(head / data / Raw(b"\x00payload"))
    # IEEE 802.15.4-2015: no sequence number, no destination, a short source in its PAN.
    control = 1 | 1 << 8 | 2 << 12 | 2 << 14
    return struct.pack("<HHH", control, 0xABCD, 3) + b"\x00payload"


def acknowledgement(index):
    return bytes(Dot15d4(fcf_frametype=2, seqnum=index % 256))


def with_fcs(frame):
    return frame + Dot15d4FCS().compute_fcs(frame)


def wrong(frame):
    return frame[:-1] + bytes([frame[-1] ^ 0xFF])


def tap(frame, level):
    """A TAP header with FCS type, RSS and channel before a frame with its FCS."""
    fields = struct.pack("<HHB3x", 0, 1, 1) + struct.pack("<HHf", 1, 4, level) + struct.pack("<HHHBx", 3, 3, 15, 0)
    return struct.pack("<BBH", 0, 0, 4 + len(fields)) + fields + frame


def beacon_80211(node, level):
    address = f"02:00:00:00:00:{node:02x}"
    radio = RadioTap(present="TSFT+Flags+Rate+Channel+dBm_AntSignal+Antenna", mac_timestamp=7, dBm_AntSignal=level)
    frame = Dot11(type=0, subtype=8, addr1="ff:ff:ff:ff:ff:ff", addr2=address, addr3=address) / Dot11Beacon() / Dot11Elt(ID=0, info=b"net")
    return bytes(radio / frame)


def clear_to_send():
    return bytes(RadioTap(present="Flags+dBm_AntSignal", dBm_AntSignal=-40) / Raw(b"\xc4\x00\x00\x00" + b"\x02" * 6))


def write(name, link, rows, nano, endianness):
    with PcapWriter(str(HERE / name), linktype=link, nano=nano, endianness=endianness) as writer:
        unit = 1 if nano else 1000
        writer.write_header(None)
        for ns, octets in rows:
            length = len(octets)
            writer.write_packet(
                octets, sec=ns // SECOND_NS, usec=ns % SECOND_NS // unit, caplen=length, wirelen=length
            )


def rows_154(of, nodes=(0, 1, 2), damaged=True):
    """Rows of a capture of frames; `of` makes octets of a frame and a level. One frame of node 2 is damaged."""
    rows = []
    for index, (ns, node, level) in enumerate(packets()):
        if node not in nodes:
            continue
        rows.append((ns, of(mac_frame(node, index), level)))
        if node == 1:
            rows.append((ns + 1_000_000, of(acknowledgement(index), -60)))
    if damaged:
        octets = of(mac_frame(2, 0), -80)
        rows.append((START_NS + 3 * SECOND_NS, wrong(octets)))
    return sorted(rows)


def main():
    write("tap.pcap", TAP, rows_154(lambda frame, level: tap(with_fcs(frame), level)), True, "<")
    write("fcs.pcap", WITH_FCS, rows_154(lambda frame, _: with_fcs(frame)), False, ">")
    write("bare.pcap", WITHOUT_FCS, rows_154(lambda frame, _: frame, nodes=(0, 1), damaged=False), False, "<")
    radio = [(ns, beacon_80211(node, level)) for ns, node, level in packets() if node == 2]
    radio += [(ns + 1_000_000, clear_to_send()) for ns, node, _ in packets() if node == 2]
    write("radiotap.pcap", RADIOTAP, sorted(radio), True, "<")
    # Two interfaces with other links and time units in one file.
    merged, parts = HERE / "mixed.pcapng", [HERE / "bare.pcap", HERE / "radiotap.pcap"]
    subprocess.run(["mergecap", "-F", "pcapng", "-I", "none", "-w", merged, *parts], check=True)
    parts[0].unlink()
    parts[1].unlink()


if __name__ == "__main__":
    main()
