"""Writes the bags beside this file: python3 write_bags.py (needs rosbags 0.11 and mcap 1.6).

All bags hold one drive, which the tests know too: for 6 s the antenna of a robot drives along y = 2 m at 0.5 m/s from
x = 0. In second k, node n is heard at 0.25 s and 0.75 s with a level of -50 - 5 n - k dBm: node 0 in each second, node 1 in
seconds 1 to 4, node 2 in second 2. Messages are recorded 20 ms after their stamps.
"""

import math
import shutil
import sqlite3
from pathlib import Path

import numpy as np
from mcap.writer import CompressionType, Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

HERE = Path(__file__).parent
START_NS = 1_700_000_000_123_456_789
SECONDS = 6
SECOND_NS = 1_000_000_000
HEARD = [range(6), range(1, 5), [2]]
DELAY_NS = 20_000_000

HEARD_MSG = """
# A packet that the radio received.
int8 NOTHING=-128
std_msgs/Header header
string<=12 radio "first"
uint16 src
int8 rssi
uint8[] payload
"""

BEACON_MSG = """
uint8[6] address
float32 rssi
uint8 sector
"""

SCAN_MSG = """
string comment
Beacon[] beacons
builtin_interfaces/Time stamp
"""

EVERYTHING_MSG = """
bool flag
byte octet
char letter
int8 i8
uint8 u8
int16 i16
uint16 u16
int32 i32
uint32 u32
int64 i64
uint64 u64
float32 f32
float64 f64
string text
std_msgs/Empty nothing
string[2] two_texts
string[] texts
float64[] reals
uint16[3] three
int64[<=4] few
Beacon[] beacons
builtin_interfaces/Duration span
std_msgs/Header header
uint8 sector
string node_id
float64 rssi_dbm
"""


def stores(store):
    types = get_typestore(store)
    for name, text in [
        ("radio_msgs/msg/Heard", HEARD_MSG),
        ("radio_msgs/msg/Beacon", BEACON_MSG),
        ("radio_msgs/msg/Scan", SCAN_MSG),
        ("radio_msgs/msg/Everything", EVERYTHING_MSG),
    ]:
        types.register(get_types_from_msg(text, name))
    return types


TYPES = stores(Stores.ROS2_HUMBLE)
TYPES1 = stores(Stores.ROS1_NOETIC)


def of(types, name, **fields):
    return types.types[name](**fields)


def stamp(types, ns):
    return of(types, "builtin_interfaces/msg/Time", sec=ns // SECOND_NS, nanosec=ns % SECOND_NS)


def header(types, ns, frame):
    more = {"seq": 0} if types is TYPES1 else {}
    return of(types, "std_msgs/msg/Header", stamp=stamp(types, ns), frame_id=frame, **more)


def vector(types, name, xyz):
    return of(types, f"geometry_msgs/msg/{name}", x=float(xyz[0]), y=float(xyz[1]), z=float(xyz[2]))


def yaw(types, angle):
    w, z = math.cos(angle / 2), math.sin(angle / 2)
    return of(types, "geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=z, w=w)


def pose(types, xyz):
    return of(types, "geometry_msgs/msg/Pose", position=vector(types, "Point", xyz), orientation=yaw(types, 0.3))


def times(rate_hz):
    """Seconds from the start and stamps."""
    return [(i / rate_hz, START_NS + i * SECOND_NS // rate_hz) for i in range(SECONDS * rate_hz + 1)]


def antenna(second):
    return [0.5 * second, 2.0, 0.0]


def packets():
    """Stamp, node, level, in the order of time."""
    found = []
    for node, seconds in enumerate(HEARD):
        for second in seconds:
            for fraction in (0.25, 0.75):
                ns = START_NS + second * SECOND_NS + int(fraction * SECOND_NS) + 1000 * node
                found.append((ns, node, -50 - 5 * node - second))
    return sorted(found)


def odometry(types, second, ns):
    covariance = np.zeros(36)
    twist = of(
        types,
        "geometry_msgs/msg/Twist",
        linear=vector(types, "Vector3", [0.5, 0, 0]),
        angular=vector(types, "Vector3", [0, 0, 0]),
    )
    return of(
        types,
        "nav_msgs/msg/Odometry",
        header=header(types, ns, "odom"),
        child_frame_id="base_link",
        pose=of(
            types, "geometry_msgs/msg/PoseWithCovariance", pose=pose(types, antenna(second)), covariance=covariance
        ),
        twist=of(types, "geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=covariance),
    )


def pose_stamped(types, second, ns):
    return of(
        types, "geometry_msgs/msg/PoseStamped", header=header(types, ns, "map"), pose=pose(types, antenna(second))
    )


def heard(types, ns, node, level):
    return of(
        types,
        "radio_msgs/msg/Heard",
        header=header(types, ns, "radio"),
        radio="first",
        src=[17, 291, 4660][node],
        rssi=level,
        payload=np.array([1, 2, 3], dtype=np.uint8),
    )


def beacon(types, node, level):
    address = np.array([0x00, 0x12, 0x4B, 0, 0, node], dtype=np.uint8)
    return of(types, "radio_msgs/msg/Beacon", address=address, rssi=float(level), sector=node)


def everything(types, ns, node, level):
    name = ["door", "lamp", "gate"][node]
    return of(
        types,
        "radio_msgs/msg/Everything",
        flag=True,
        octet=100,
        letter=65,
        i8=-5,
        u8=250,
        i16=-30000,
        u16=60000,
        i32=-2_000_000_000,
        u32=4_000_000_000,
        i64=-9_000_000_000_000_000_000,
        u64=18_000_000_000_000_000_000,
        f32=-1.5,
        f64=1e300,
        text="grüße" * (node + 1),
        nothing=of(types, "std_msgs/msg/Empty", **({"structure_needs_at_least_one_member": 0} if types is TYPES else {})),
        two_texts=["", "b"],
        texts=["x"] * node,
        reals=np.arange(node, dtype=np.float64),
        three=np.array([1, 2, 3], dtype=np.uint16),
        few=np.array([-1, 2], dtype=np.int64),
        beacons=[beacon(types, 0, -90), beacon(types, 1, -91)][: node + 1],
        span=of(types, "builtin_interfaces/msg/Duration", sec=-1, nanosec=5),
        header=header(types, ns, "a"),
        sector=node,
        node_id=name,
        rssi_dbm=float(level),
    )


def transforms(types, links):
    """Of (stamp, parent, child, translation, yaw)."""
    return of(
        types,
        "tf2_msgs/msg/TFMessage",
        transforms=[
            of(
                types,
                "geometry_msgs/msg/TransformStamped",
                header=header(types, ns, parent),
                child_frame_id=child,
                transform=of(
                    types,
                    "geometry_msgs/msg/Transform",
                    translation=vector(types, "Vector3", xyz),
                    rotation=yaw(types, angle),
                ),
            )
            for ns, parent, child, xyz, angle in links
        ],
    )


def drive_odometry(types):
    """Topic, type, stamp, message."""
    rows = [("/odom", "nav_msgs/msg/Odometry", ns, odometry(types, s, ns)) for s, ns in times(2)]
    rows += [("/radio", "radio_msgs/msg/Heard", ns, heard(types, ns, n, level)) for ns, n, level in packets()]
    text = of(types, "std_msgs/msg/String", data="hello")
    rows += [("/chatter", "std_msgs/msg/String", ns, text) for _, ns in times(1)]
    return sorted(rows, key=lambda row: (row[2], row[0]))


def drive_transforms(types):
    rows = []
    # The antenna is at (0.1, 0, 0.4) from the base, whose yaw in the map is 0.
    for second, ns in times(4):
        base = np.subtract(antenna(second), [0.1, 0.0, 0.4])
        dx, dy, dz = base - np.array([10 + 0.1 * second, -3.0, 0.0])
        link = (ns, "odom", "base_link", [dy, -dx, dz], -math.pi / 2)
        rows.append(("/tf", "tf2_msgs/msg/TFMessage", ns, transforms(types, [link])))
    for second, ns in times(1):
        link = (ns, "map", "odom", [10 + 0.1 * second, -3, 0], math.pi / 2)
        other = (ns, "base_link", "wheel", [0, 0, 0], 0.1 * second)
        rows.append(("/tf", "tf2_msgs/msg/TFMessage", ns, transforms(types, [link, other])))
    link = (0, "base_link", "antenna", [0.1, 0, 0.4], 0.0)
    rows.append(("/tf_static", "tf2_msgs/msg/TFMessage", START_NS, transforms(types, [link])))
    scans = {}
    for ns, node, level in packets():
        scans.setdefault(ns // 1_000_000, []).append((ns, node, level))
    for group in scans.values():
        beacons = [beacon(types, node, level) for _, node, level in group]
        scan = of(types, "radio_msgs/msg/Scan", comment="x", beacons=beacons, stamp=stamp(types, group[0][0]))
        rows.append(("/scan", "radio_msgs/msg/Scan", group[0][0], scan))
    return sorted(rows, key=lambda row: (row[2], row[0]))


def drive_everything(types):
    rows = [("/pose", "geometry_msgs/msg/PoseStamped", ns, pose_stamped(types, s, ns)) for s, ns in times(2)]
    rows += [("/all", "radio_msgs/msg/Everything", ns, everything(types, ns, n, level)) for ns, n, level in packets()]
    return sorted(rows, key=lambda row: (row[2], row[0]))


def drive_fixes(types):
    """The drive east from 48.58 N, 7.75 E; the first message has no fix."""
    lat, lon, height = 48.58, 7.75, 150.0
    # One metre east in degrees of longitude: NIMA TR8350.2, radius of curvature in the prime vertical.
    a, e2 = 6378137.0, 6.69437999014e-3
    radius = a / math.sqrt(1 - e2 * math.sin(math.radians(lat)) ** 2) + height
    rows = []
    for second, ns in times(2):
        east = math.degrees(antenna(second)[0] / (radius * math.cos(math.radians(lat))))
        status = of(types, "sensor_msgs/msg/NavSatStatus", status=0, service=1)
        fix = of(
            types,
            "sensor_msgs/msg/NavSatFix",
            header=header(types, ns, "gps"),
            status=status,
            latitude=lat,
            longitude=lon + east,
            altitude=height,
            position_covariance=np.zeros(9),
            position_covariance_type=0,
        )
        rows.append(("/fix", "sensor_msgs/msg/NavSatFix", ns, fix))
    nan, ns = float("nan"), START_NS - SECOND_NS
    lost = of(types, "sensor_msgs/msg/NavSatStatus", status=-1, service=1)
    none = of(
        types,
        "sensor_msgs/msg/NavSatFix",
        header=header(types, ns, "gps"),
        status=lost,
        latitude=nan,
        longitude=nan,
        altitude=nan,
        position_covariance=np.zeros(9),
        position_covariance_type=0,
    )
    rows.append(("/fix", "sensor_msgs/msg/NavSatFix", ns, none))
    rows += [("/radio", "radio_msgs/msg/Heard", ns, heard(types, ns, n, level)) for ns, n, level in packets()]
    return sorted(rows, key=lambda row: (row[2], row[0]))


def with_rosbags(folder, rows, compress=False):
    """A folder as `ros2 bag record -s mcap` writes it."""
    shutil.rmtree(folder, ignore_errors=True)
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    if compress:
        writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, kind, ns, message in rows:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=TYPES)
            writer.write(connections[topic], ns + DELAY_NS, TYPES.serialize_cdr(message, kind))


def with_sqlite(folder, rows, is_humble=False):
    """A folder as `ros2 bag record -s sqlite3` writes it; before Iron the file had no definitions of messages."""
    shutil.rmtree(folder, ignore_errors=True)
    with Writer(folder, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connections = {}
        for topic, kind, ns, message in rows:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=TYPES)
            writer.write(connections[topic], ns + DELAY_NS, TYPES.serialize_cdr(message, kind))
    with sqlite3.connect(folder / f"{folder.name}.db3", isolation_level=None) as file:
        if is_humble:
            file.execute("DROP TABLE message_definitions")
            file.execute("ALTER TABLE topics DROP COLUMN type_description_hash")
        file.execute("PRAGMA page_size = 512")
        file.execute("VACUUM")


def with_mcap(path, rows, types, serialize, profile, compression):
    """A file as other programs write it."""
    ros = 1 if profile == "ros1" else 2
    with path.open("wb") as file:
        writer = McapWriter(file, compression=compression, chunk_size=2048)
        writer.start(profile=profile, library="write_bags.py")
        channels = {}
        for topic, kind, ns, message in rows:
            if topic not in channels:
                text, _ = types.generate_msgdef(kind, ros_version=ros)
                name = kind.replace("/msg/", "/") if ros == 1 else kind
                schema = writer.register_schema(name=name, encoding=f"ros{ros}msg", data=text.encode())
                encoding = "ros1" if ros == 1 else "cdr"
                channels[topic] = writer.register_channel(topic=topic, message_encoding=encoding, schema_id=schema)
            time = ns + DELAY_NS
            writer.add_message(channels[topic], log_time=time, data=bytes(serialize(message, kind)), publish_time=time)
        writer.finish()


def split(folder, rows):
    """Two files in one folder, with the metadata of both."""
    half = START_NS + SECONDS * SECOND_NS // 2
    parts = [folder.with_name(f"{folder.name}_{part}") for part in range(2)]
    with_rosbags(parts[0], [row for row in rows if row[2] < half])
    with_rosbags(parts[1], [row for row in rows if row[2] >= half])
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for part in parts:
        shutil.move(part / f"{part.name}.mcap", folder / f"{part.name}.mcap")
    metadata = (parts[0] / "metadata.yaml").read_text()
    listed = f"- {parts[0].name}.mcap"
    line = next(line for line in metadata.splitlines() if line.strip() == listed)
    second = line.replace(parts[0].name, parts[1].name)
    (folder / "metadata.yaml").write_text(metadata.replace(line, f"{line}\n{second}", 1))
    for part in parts:
        shutil.rmtree(part)


def main():
    with_rosbags(HERE / "odometry", drive_odometry(TYPES))
    split(HERE / "split", drive_odometry(TYPES))
    with_rosbags(HERE / "transforms", drive_transforms(TYPES), compress=True)

    with_sqlite(HERE / "sqlite", drive_odometry(TYPES))
    with_sqlite(HERE / "sqlite_humble", drive_odometry(TYPES), is_humble=True)

    def big(message, kind):
        return TYPES.serialize_cdr(message, kind, little_endian=False)

    with_mcap(HERE / "big_endian.mcap", drive_everything(TYPES), TYPES, big, "ros2", CompressionType.LZ4)
    little = TYPES.serialize_cdr
    with_mcap(HERE / "little_endian.mcap", drive_everything(TYPES), TYPES, little, "", CompressionType.ZSTD)
    with_mcap(HERE / "fixes.mcap", drive_fixes(TYPES), TYPES, little, "ros2", CompressionType.ZSTD)
    one = TYPES1.serialize_ros1
    with_mcap(HERE / "ros1.mcap", drive_odometry(TYPES1), TYPES1, one, "ros1", CompressionType.ZSTD)


if __name__ == "__main__":
    main()
