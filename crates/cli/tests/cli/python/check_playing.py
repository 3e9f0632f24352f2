"""Checks with independent readers that a recording of a run plays: what is drawn over time says the same as the log.

Usage: check_playing.py FILE.mcap [LAYOUT.foxglove.json]
Needs: pip install mcap mcap-protobuf-support
Prints the number of messages of each kind of drawing as one JSON object.
"""

import json
import math
import sys
from collections import defaultdict

from check_recording import points, seconds_ns
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory


def require(condition, message):
    if not condition:
        raise SystemExit(message)


def xyz(p):
    return (p.x, p.y, p.z)


def read(path):
    """The messages of each topic in the order of the file, each with its time."""
    topics = defaultdict(list)
    schemas = {}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages(log_time_order=False):
            topics[channel.topic].append((message.log_time, decoded))
            schemas[channel.topic] = schema.name
    return topics, schemas


def check_times(topics, schemas):
    """Each topic is in the order of time, and a drawing has the time of its message."""
    for topic, messages in topics.items():
        times = [time for time, _ in messages]
        if topic not in ("/tf", "/receptions", "/stops", "/metrics", "/log", "/mac/frames", "/mac/air"):
            require(times == sorted(times), f"{topic}: its times are not in order")
        if schemas[topic].startswith("foxglove.") and schemas[topic] != "foxglove.SceneUpdate":
            for time, message in messages:
                require(seconds_ns(message.timestamp) == time, f"{topic}: its timestamp is not its time {time}")


def check_ways(topics):
    """Where a robot is known to be is on its drawn way, and in the end the way is its whole path."""
    count = 0
    for topic in [topic for topic in topics if topic.startswith("/robot/") and topic.endswith("/path")]:
        robot = topic.split("/")[2]
        path = [xyz(pose.position) for pose in topics[topic][-1][1].poses]
        if len(path) < 2:
            continue
        [entity] = topics[f"/robot/{robot}/way"][-1][1].entities
        require([xyz(p) for p in entity.lines[0].points] == path, f"{robot}: its way is not its path")
        drawn = set()
        for _, update in topics[f"/robot/{robot}/legs"]:
            for leg in update.entities:
                drawn.add(tuple(xyz(p) for p in leg.lines[0].points))
        ways = [[xyz(p) for p in way.entities[0].lines[0].points] for _, way in topics[f"/robot/{robot}/way"]]
        for way in ways:
            require(way == path[: len(way)], f"{robot}: a way is not the beginning of its path")
            drawn.update(zip(way, way[1:]))
        legs = set(zip(path, path[1:]))
        require(legs == drawn, f"{robot}: {len(legs ^ drawn)} legs are not both driven and drawn")
        count += len(topics[f"/robot/{robot}/legs"])
    return count


def check_listening(topics):
    """Lines go from each stop to the true places of the nodes that were heard there, and to no other place."""
    nodes = {p["node"]: (p["x"], p["y"], p["z"]) for p in points(topics["/world/nodes"][0][1])}
    heard = defaultdict(set)
    for _, reception in topics["/receptions"]:
        if reception.received > 0:
            heard[reception.stop].add(nodes[reception.node])
    robots = {stop.robot for _, stop in topics["/stops"]}
    marks = {robot: iter(topics[f"/robot/{robot}/stops"]) for robot in robots}
    lines = {robot: iter(topics[f"/robot/{robot}/heard"]) for robot in robots}
    count = 0
    for time, stop in topics["/stops"]:
        place = (stop.x_m, stop.y_m, stop.z_m)
        at, cloud = next(marks[stop.robot])
        [mark] = points(cloud)
        require((at, (mark["x"], mark["y"], mark["z"])) == (time, place), f"stop {stop.stop}: its mark is elsewhere")
        require(mark["heard"] == len(heard[stop.stop]), f"stop {stop.stop}: its mark has another number of nodes")
        if heard[stop.stop]:
            at, update = next(lines[stop.robot])
            [entity] = update.entities
            [line] = entity.lines
            pairs = [line.indices[i : i + 2] for i in range(0, len(line.indices), 2)]
            ends = {xyz(line.points[b]) for _, b in pairs}
            require(at == time and ends == heard[stop.stop], f"stop {stop.stop}: lines to other nodes than were heard")
            require(all(xyz(line.points[a]) == place for a, _ in pairs), f"stop {stop.stop}: lines from elsewhere")
            require(entity.lifetime.seconds + entity.lifetime.nanos > 0, f"stop {stop.stop}: its lines stay for ever")
            count += 1
    for of, rest in [("marks", marks), ("lines", lines)]:
        require(all(next(messages, None) is None for messages in rest.values()), f"more {of} than stops")
    return count


def check_robots(topics):
    """A robot is at one place at a time, and its places come in the order of time."""
    last = {}
    for time, transform in topics["/tf"]:
        robot, place = transform.child_frame_id, xyz(transform.translation)
        if robot in last and time == last[robot][0]:
            require(math.dist(place, last[robot][1]) < 1e-9, f"{robot} is at two places at {time} ns")
        require(robot not in last or time >= last[robot][0], f"{robot}: its times are not in order")
        last[robot] = (time, place)
    return len(last)


def check_layout(path, topics):
    """Each topic of a layout for Foxglove is in the recording."""
    with open(path, encoding="utf-8") as file:
        layout = json.load(file)
    require(layout["version"] == 1, "another version of layouts")
    panels = []

    def visit(content):
        if content["type"] == "split":
            for item in content["items"]:
                require(item["proportion"] > 0, "a part without room")
                visit(item["content"])
        else:
            panels.append(content)

    visit(layout["content"])
    kinds = {panel["panelType"]: panel["config"] for panel in panels}
    require({"ThreeDee", "Plot", "Log", "Table"} == set(kinds), f"panels {sorted(kinds)}")
    missing = set(kinds["ThreeDee"]["topics"]) - set(topics)
    require(not missing, f"topics of the layout that the recording lacks: {sorted(missing)}")
    require(kinds["Table"]["topicPath"] in topics, "a table of a topic that the recording lacks")


def main(path, *layouts):
    topics, schemas = read(path)
    check_times(topics, schemas)
    counts = {"robots": check_robots(topics), "legs": check_ways(topics)}
    counts["heard"] = check_listening(topics) if "/stops" in topics else 0
    counts["maps"] = {topic: len(topics[topic]) for topic in sorted(topics) if topic.startswith("/map/")}
    names = topics.get("/world/names", [])
    counts["names"] = sum(len(entity.texts) for _, update in names for entity in update.entities)
    for layout in layouts:
        check_layout(layout, topics)
    json.dump(counts, sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
