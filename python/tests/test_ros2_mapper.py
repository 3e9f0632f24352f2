"""The ROS 2 example, with small stand-ins for rclpy and the messages."""

from __future__ import annotations

import importlib
import json
import math
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import sextant

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"


def vector() -> SimpleNamespace:
    return SimpleNamespace(x=0.0, y=0.0, z=0.0)


def pose() -> SimpleNamespace:
    return SimpleNamespace(position=vector(), orientation=SimpleNamespace(x=0.0, y=0.0, z=0.0, w=0.0))


class Message:
    def __init__(self) -> None:
        self.header = SimpleNamespace(frame_id="", stamp=SimpleNamespace(sec=0, nanosec=0))


class PoseStamped(Message):
    def __init__(self) -> None:
        super().__init__()
        self.pose = pose()


class PoseWithCovarianceStamped(Message):
    def __init__(self) -> None:
        super().__init__()
        self.pose = SimpleNamespace(pose=pose(), covariance=[0.0] * 36)


class Odometry(PoseWithCovarianceStamped):
    pass


class String:
    def __init__(self, data: str = "") -> None:
        self.data = data


class Marker(PoseStamped):
    SPHERE, CYLINDER, ADD = 2, 3, 0

    def __init__(self) -> None:
        super().__init__()
        self.scale = vector()
        self.color = SimpleNamespace(r=0.0, g=0.0, b=0.0, a=0.0)


class MarkerArray:
    def __init__(self) -> None:
        self.markers: list[Marker] = []


class Node:
    parameters: dict[str, Any] = {}

    def __init__(self, name: str) -> None:
        self.published: dict[str, list[Any]] = {}
        self.subscribed: dict[str, tuple[Any, Any]] = {}
        self.warnings: list[str] = []
        self.period_s, self.now_s = 0.0, 0.0

    def declare_parameter(self, name: str, default: Any) -> SimpleNamespace:
        return SimpleNamespace(value=self.parameters.get(name, default))

    def create_publisher(self, kind: Any, topic: str, depth: int) -> SimpleNamespace:
        self.published[topic] = []

        def publish(message: Any) -> None:
            assert isinstance(message, kind)
            self.published[topic].append(message)

        return SimpleNamespace(publish=publish)

    def create_subscription(self, kind: Any, topic: str, callback: Any, depth: int) -> None:
        self.subscribed[topic] = (kind, callback)

    def create_timer(self, period_s: float, callback: Any) -> None:
        self.period_s = period_s

    def get_clock(self) -> SimpleNamespace:
        nanoseconds = round(self.now_s * 1e9)
        stamp = SimpleNamespace(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=nanoseconds, to_msg=lambda: stamp))

    def get_logger(self) -> SimpleNamespace:
        return SimpleNamespace(warning=self.warnings.append)


MODULES = {
    "rclpy": {},
    "rclpy.node": {"Node": Node},
    "geometry_msgs.msg": {"PoseStamped": PoseStamped, "PoseWithCovarianceStamped": PoseWithCovarianceStamped},
    "nav_msgs.msg": {"Odometry": Odometry},
    "std_msgs.msg": {"String": String},
    "visualization_msgs.msg": {"Marker": Marker, "MarkerArray": MarkerArray},
}


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    for name, members in MODULES.items():
        module = ModuleType(name)
        vars(module).update(members)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.delitem(sys.modules, "ros2_mapper", raising=False)
    # An algorithm that takes little time.
    monkeypatch.setattr(Node, "parameters", {"algorithm": "ml-tm"})
    return importlib.import_module("ros2_mapper")


def drive(mapper: Any) -> None:
    """Tell a mapper what the robot of a simulated run heard."""
    run = sextant.Scenario.template("survey", seed=1).run()
    stops, heard = run.stops.to_dict(), run.receptions.to_dict()
    at_stop: dict[Any, list[tuple[str, int, float | None]]] = {}
    for node, stop, received, rssi in zip(heard["node"], heard["stop"], heard["received"], heard["rssi_dbm"], strict=True):
        at_stop.setdefault(stop, []).append((node, received, rssi))
    for stop, t_s, x_m, y_m in zip(stops["stop"], stops["t_s"], stops["x_m"], stops["y_m"], strict=True):
        message = Odometry() if mapper.pose_type == "odometry" else PoseStamped()
        message.header.frame_id = "odom"
        nanoseconds = round(t_s * 1e9)
        message.header.stamp = SimpleNamespace(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        place = (message.pose.pose if mapper.pose_type == "odometry" else message.pose).position
        place.x, place.y = x_m, y_m
        mapper.now_s = t_s
        mapper.on_pose(message)
        for node, received, rssi in at_stop.get(stop, []):
            packet = json.dumps({"node": node, "rssi_dbm": -70.0 if rssi is None else rssi})
            for _ in range(received):
                mapper.on_packet(String(packet))
    mapper.on_timer()


@pytest.mark.parametrize("kind", ["pose", "odometry"])
def test_the_map_is_published_in_the_frame_of_the_poses(example: ModuleType, kind: str) -> None:
    Node.parameters = Node.parameters | {"pose_type": kind, "pose_topic": "/where", "period_s": 5.0}
    mapper = example.Ros2Mapper()
    assert mapper.subscribed["/where"][0] is {"pose": PoseStamped, "odometry": Odometry}[kind]
    assert mapper.period_s == 5.0
    drive(mapper)
    markers = mapper.published["map_of_nodes"][0].markers
    spheres = [one for one in markers if one.type == Marker.SPHERE]
    assert len(spheres) == 36
    assert {one.header.frame_id for one in markers} == {"odom"}
    assert len({(one.ns, one.id) for one in markers}) == len(markers)
    assert mapper.warnings == []


def test_covariances_and_ellipses_say_the_same(example: ModuleType) -> None:
    mapper = example.Ros2Mapper()
    drive(mapper)
    places = {one.node: one for one in mapper.live.map()}
    message = mapper.published["nodes/node_n0"][0]
    entries = message.pose.covariance
    assert len(entries) == 36 and entries[1] == entries[6]
    assert (entries[0], entries[1], entries[7]) == (places["n0"].xx_m2, places["n0"].xy_m2, places["n0"].yy_m2)
    at = (message.pose.pose.position.x, message.pose.pose.position.y)
    markers = mapper.published["map_of_nodes"][0].markers
    region = next(
        one for one in markers if one.type == Marker.CYLINDER and (one.pose.position.x, one.pose.position.y) == at
    )
    # The product of the half axes is that of the 95 % region: 5.99 times the root of the determinant.
    area = region.scale.x * region.scale.y / 4.0
    assert area == pytest.approx(5.991464547107979 * math.sqrt(entries[0] * entries[7] - entries[1] ** 2))


def test_the_ellipse_of_a_known_covariance_has_its_axes_and_direction(example: ModuleType) -> None:
    mapper = example.Ros2Mapper()
    # Standard deviations of 3 m at 45 degrees, and of 1 m across.
    place = example.Place("n", 2.0, 7.0, 0.0, 5.0, 4.0, 5.0)
    sphere, region = mapper._marker_array([place]).markers
    assert (sphere.type, region.type) == (Marker.SPHERE, Marker.CYLINDER)
    axis = 2.0 * math.sqrt(5.991464547107979)
    assert (region.scale.x, region.scale.y) == pytest.approx((3.0 * axis, 1.0 * axis))
    turn = region.pose.orientation
    assert 2.0 * math.atan2(turn.z, turn.w) == pytest.approx(math.pi / 4.0)
    message = mapper._pose_with_covariance(place)
    at = {index: entry for index, entry in enumerate(message.pose.covariance) if entry != 0.0}
    unknown = {14: 1e6, 21: 1e6, 28: 1e6, 35: 1e6}
    assert at == {0: 5.0, 1: 4.0, 6: 4.0, 7: 5.0, **unknown}


def test_the_goal_is_where_the_robot_was_not(example: ModuleType) -> None:
    mapper = example.Ros2Mapper()
    drive(mapper)
    expected = mapper.live.next_stop(mapper.live.map())
    goals = mapper.published["next_stop"]
    assert [(one.pose.position.x, one.pose.position.y) for one in goals] == ([] if expected is None else [expected])
    assert all(one.header.frame_id == "odom" and one.pose.orientation.w == 1.0 for one in goals)


@pytest.mark.parametrize("data", [
    "no JSON", '{"node": "n1"}', "[]", '{"node": "n1", "rssi_dbm": "loud"}',
    '{"node": "n1", "rssi_dbm": NaN}', '{"node": "n1", "rssi_dbm": 1e999}'])
def test_a_bad_packet_is_left_out_with_a_warning(example: ModuleType, data: str) -> None:
    mapper = example.Ros2Mapper()
    mapper.on_packet(String(data))
    assert len(mapper.warnings) == 1 and repr(data) in mapper.warnings[0]


def test_a_late_pose_and_a_pose_in_another_frame_are_left_out_with_a_warning(example: ModuleType) -> None:
    Node.parameters = Node.parameters | {"frame_id": "map"}
    mapper = example.Ros2Mapper()
    message = PoseStamped()
    message.header.frame_id = "odom"
    mapper.on_pose(message)
    assert "'odom'" in mapper.warnings[-1] and "'map'" in mapper.warnings[-1]
    message.header.frame_id = "map"
    mapper.on_pose(message)
    assert len(mapper.warnings) == 1
    mapper.on_pose(message)
    assert "not later than the last" in mapper.warnings[-1]


def test_too_little_gives_no_map_and_says_why(example: ModuleType) -> None:
    mapper = example.Ros2Mapper()
    mapper.on_timer()
    assert mapper.warnings == ["no map yet: poses: 0; at least 2 are needed"]
    assert mapper.published["map_of_nodes"] == []


def test_an_unknown_pose_type_is_refused(example: ModuleType) -> None:
    Node.parameters = Node.parameters | {"pose_type": "twist"}
    with pytest.raises(ValueError, match="'twist'; allowed: pose, odometry"):
        example.Ros2Mapper()
