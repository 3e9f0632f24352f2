"""Shows a recording of Sextant in Rerun while it plays.

Rerun itself draws the point clouds, the transforms and the log. This script adds what Rerun does not read: obstacles, ways,
lines to the nodes that were heard, names, marks of captured targets, frames on air, and the time series.

Needs: pip install rerun-sdk mcap mcap-protobuf-support
Usage: python NAME.rerun.py [RUN.mcap] [--save OUT.rrd]     without --save, the viewer opens
"""

import argparse
import pathlib

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

SHOWN = {}
TIMELINE = "message_log_time"


def color(c):
    return [round(255 * channel) for channel in (c.r, c.g, c.b, c.a)]


def place(p):
    return [p.x, p.y, p.z]


def draw(path, entity):
    """Draws an entity of a SceneUpdate below `path`."""

    def log(part, drawing):
        rr.log(f"{path}/{part}", drawing)
        rr.log(f"{path}/{part}", rr.CoordinateFrame(entity.frame_id))

    for i, line in enumerate(entity.lines):
        points = np.array([place(p) for p in line.points])
        if line.type == 2:
            pairs = np.array(line.indices or range(len(points)), dtype=int).reshape(-1, 2)
            strips = points[pairs]
        else:
            strips = [points]
        log(f"lines/{i}", rr.LineStrips3D(strips, colors=color(line.color), radii=rr.Radius.ui_points(0.75)))
    for i, surface in enumerate(entity.triangles):
        mesh = rr.Mesh3D(
            vertex_positions=[place(p) for p in surface.points],
            triangle_indices=np.array(surface.indices).reshape(-1, 3),
            albedo_factor=color(surface.color),
        )
        log(f"triangles/{i}", mesh)
    if entity.texts:
        points = rr.Points3D(
            [place(t.pose.position) for t in entity.texts],
            labels=[t.text for t in entity.texts],
            colors=[color(t.color) for t in entity.texts],
            show_labels=True,
        )
        log("texts", points)
    for i, ball in enumerate(entity.spheres):
        sphere = rr.Ellipsoids3D(
            centers=[place(ball.pose.position)],
            half_sizes=[[ball.size.x / 2, ball.size.y / 2, ball.size.z / 2]],
            colors=color(ball.color),
        )
        log(f"spheres/{i}", sphere)


def at(time_ns):
    rr.set_time(TIMELINE, timestamp=np.datetime64(time_ns, "ns"))


def part(name):
    return rr.escape_entity_path_part(name)


def add(recording):
    """Adds the scenes and the time series of the recording."""
    with open(recording, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        drawn, ends = {}, []
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=SHOWN["scenes"] + ["/metrics"]):
            now = message.log_time
            for end, path, begun in [e for e in ends if e[0] <= now]:
                if drawn.get(path) == begun:
                    at(end)
                    rr.log(path, rr.Clear(recursive=True))
            ends = [e for e in ends if e[0] > now]
            at(now)
            if channel.topic == "/metrics":
                rr.log("/metrics/" + "/".join(map(part, decoded.name.split("/"))), rr.Scalars(decoded.value))
                continue
            topic = "/drawn" + channel.topic
            if decoded.deletions:
                rr.log(topic, rr.Clear(recursive=True))
            for entity in decoded.entities:
                path = f"{topic}/{part(entity.id)}"
                drawn[path] = now
                draw(path, entity)
                span = entity.lifetime.seconds * 1_000_000_000 + entity.lifetime.nanos
                if span > 0:
                    ends.append((now + span, path, now))


def blueprint():
    everything = rrb.VisibleTimeRange(
        TIMELINE, start=rrb.TimeRangeBoundary.infinite(), end=rrb.TimeRangeBoundary.cursor_relative()
    )
    kept = {topic: rrb.VisibleTimeRanges([everything]) for topic in SHOWN["kept"]}
    hidden = [f"- {topic}/**" for topic in SHOWN["hidden"]] + [f"- /drawn{topic}/**" for topic in SHOWN["hidden"]]
    world = rrb.Spatial3DView(
        name="World",
        origin="/",
        contents=[f"+ /{part}/**" for part in ("tf", "world", "map", "robot", "application", "drawn")] + hidden,
        overrides=kept,
        spatial_information=rrb.SpatialInformation(target_frame="world"),
        eye_controls=rrb.EyeControls3D(position=SHOWN["eye"], look_target=SHOWN["middle"], eye_up=[0, 0, 1]),
    )
    beside = []
    if SHOWN["has_metrics"]:
        beside.append(rrb.TimeSeriesView(name="Over time", origin="/metrics", contents=["+ $origin/**", "- $origin"]))
    if SHOWN["has_log"]:
        beside.append(rrb.TextLogView(name="Log", origin="/log"))
    views = rrb.Horizontal(world, rrb.Vertical(*beside), column_shares=[2, 1]) if beside else world
    return rrb.Blueprint(views, rrb.TimePanel(timeline=TIMELINE, state="expanded"), collapse_panels=True)


def main():
    beside = pathlib.Path(__file__).parent / SHOWN["recording"]
    parser = argparse.ArgumentParser(description="Shows a recording of Sextant in Rerun.")
    parser.add_argument("recording", nargs="?", default=beside, help="the recording [default: %(default)s]")
    parser.add_argument("--save", metavar="OUT.rrd", help="write a file for Rerun and do not open the viewer")
    arguments = parser.parse_args()
    rr.init("sextant", spawn=not arguments.save)
    if arguments.save:
        rr.save(arguments.save, default_blueprint=blueprint())
    else:
        rr.send_blueprint(blueprint())
    rr.log_file_from_path(arguments.recording)
    add(arguments.recording)


if __name__ == "__main__":
    main()
