"""Decodes every message of a recording with independent readers, compares what is inside with what was written, and
prints it as one JSON object.

Usage: check_recording.py FILE.mcap [EXPECTED.json]
Needs: pip install mcap mcap-protobuf-support
"""

import json
import struct
import sys

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


def points(cloud):
    """The points of a PointCloud by its own description of its fields."""
    formats = {1: "B", 2: "b", 3: "H", 4: "h", 5: "I", 6: "i", 7: "f", 8: "d"}
    count = len(cloud.data) // cloud.point_stride
    return [
        {
            field.name: struct.unpack_from("<" + formats[field.type], cloud.data, i * cloud.point_stride + field.offset)[0]
            for field in cloud.fields
        }
        for i in range(count)
    ]


def seconds_ns(timestamp):
    return timestamp.seconds * 1_000_000_000 + timestamp.nanos


def in_order(point):
    """The values of a point: its node first, if it has one, then its place."""
    names = [name for name in ["node", "x", "y", "z"] if name in point]
    return [point[name] for name in names + [name for name in point if name not in names]]


def entity(e):
    """An obstacle, or a drawing that changes."""
    if e.triangles:
        return [e.id, len(e.triangles[0].points), list(e.triangles[0].indices)]
    place = lambda p: [p.x, p.y, p.z]
    return {
        "id": e.id,
        "lifetime_ns": seconds_ns(e.lifetime),
        "lines": [[line.type, [place(p) for p in line.points], list(line.indices)] for line in e.lines],
        "texts": [[t.text, place(t.pose.position)] for t in e.texts],
        "spheres": [place(ball.pose.position) for ball in e.spheres],
    }


def plain(schema, m):
    """What is compared with what was written, as JSON can hold it."""
    if schema == "sextant.Reception":
        sector = m.sector if m.HasField("sector") else None
        rssi = m.rssi_dbm if m.HasField("rssi_dbm") else None
        return [m.node, m.stop, m.received, m.sent, sector, rssi]
    if schema == "sextant.Stop":
        return [m.stop, m.time_ns, m.x_m, m.y_m, m.z_m, m.robot, m.receptions]
    if schema == "sextant.Nodes":
        return [m.first, list(m.names)]
    if schema == "sextant.Contact":
        return [m.time_ns, m.x_m, m.y_m, m.z_m]
    if schema == "sextant.Link":
        return [m.listener, m.sender, m.received, m.sent, m.rssi_dbm if m.HasField("rssi_dbm") else None]
    if schema == "sextant.Anchor":
        return [m.node, m.x_m, m.y_m, m.z_m]
    if schema == "sextant.Frame":
        return [m.start_ns, m.airtime_ns, m.source, m.mpdu.hex(), m.outcome, m.power_dbm, m.network]
    if schema == "sextant.Networks":
        return list(m.names)
    if schema == "sextant.Sector":
        return [m.sector, m.azimuth_from_deg, m.azimuth_to_deg, m.elevation_from_deg, m.elevation_to_deg]
    if schema == "sextant.SectorGains":
        return [m.antenna, m.yaw_rad, m.pitch_rad, m.roll_rad]
    if schema == "sextant.SectorSnrs":
        return [m.stop, list(m.node), list(m.sector), list(m.snr_db)]
    if schema == "sextant.Sensors":
        names = ["target_radius_m", "field_interval_s", "field_offset_snr_db", "field_noise_snr_db"]
        return [getattr(m, name) if m.HasField(name) else None for name in names]
    if schema == "sextant.Sensed":
        return [m.time_ns, m.node, m.what, m.name, m.value if m.HasField("value") else None]
    if schema == "sextant.MappedNode":
        # Fields that are present: optional ones that were set, and others that are not zero.
        return {field.name: value for field, value in m.ListFields()}
    if schema == "sextant.Metric":
        return [m.time_ns, m.name, m.value]
    if schema == "foxglove.PointCloud":
        # An error that is not a number is null in JSON.
        return [[value if value == value else None for value in in_order(p)] for p in points(m)]
    if schema == "foxglove.FrameTransform":
        t, r = m.translation, m.rotation
        return [seconds_ns(m.timestamp), m.parent_frame_id, m.child_frame_id, [t.x, t.y, t.z], [r.z, r.w]]
    if schema == "foxglove.PosesInFrame":
        return [m.frame_id, [[p.position.x, p.position.y, p.position.z] for p in m.poses]]
    if schema == "foxglove.SceneUpdate":
        return [{"deleted": d.type} for d in m.deletions] + [entity(e) for e in m.entities]
    if schema == "foxglove.Grid":
        corner = m.pose.position
        values = struct.unpack(f"<{len(m.data) // m.cell_stride}f", m.data)
        return [m.column_count, m.row_stride, [corner.x, corner.y], m.cell_size.x, [str(v) for v in values]]
    if schema == "foxglove.Log":
        return [seconds_ns(m.timestamp), m.level, m.name, m.message]
    raise SystemExit(f"unknown schema {schema}")


def contents(path):
    """All that is in the recording, as JSON can hold it."""
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        header, summary = reader.get_header(), reader.get_summary()
        topics = {}
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            if message.log_time != message.publish_time:
                raise SystemExit(f"{channel.topic}: log_time and publish_time differ")
            topic = topics.setdefault(channel.topic, {"schema": schema.name, "encoding": schema.encoding, "messages": []})
            if message.sequence != len(topic["messages"]):
                raise SystemExit(f"{channel.topic}: sequence {message.sequence} at message {len(topic['messages'])}")
            topic["messages"].append(plain(schema.name, decoded))
        counted = sum(len(topic["messages"]) for topic in topics.values())
        if summary.statistics.message_count != counted:
            raise SystemExit(f"{counted} messages, but the summary has {summary.statistics.message_count}")
        return {
            "library": header.library,
            "profile": header.profile,
            "chunks": len(summary.chunk_indexes),
            "compression": sorted({index.compression for index in summary.chunk_indexes}),
            "topics": topics,
            "attachments": {a.name: a.data.decode() for a in reader.iter_attachments()},
            "metadata": {m.name: m.metadata for m in reader.iter_metadata()},
        }


def differences(expected, found, place):
    """Where the two differ: exact equality, numbers included."""
    if isinstance(expected, dict) and isinstance(found, dict):
        for key in sorted(expected.keys() | found.keys()):
            if key not in expected or key not in found:
                yield f"{place}: `{key}` is only {'found' if key in found else 'expected'}"
            else:
                yield from differences(expected[key], found[key], f"{place}.{key}")
    elif isinstance(expected, list) and isinstance(found, list):
        if len(expected) != len(found):
            yield f"{place}: {len(found)} entries, expected {len(expected)}"
        for i, (one, other) in enumerate(zip(expected, found)):
            yield from differences(one, other, f"{place}[{i}]")
    elif expected != found:
        yield f"{place}: {found!r}, expected {expected!r}"


def main(path, *expected):
    found = contents(path)
    json.dump(found, sys.stdout)
    for name in expected:
        with open(name, encoding="utf-8") as file:
            for key, value in json.load(file).items():
                wrong = list(differences(value, found.get(key), key))
                if wrong:
                    raise SystemExit("\n".join(wrong[:10]))


if __name__ == "__main__":
    main(*sys.argv[1:])
