"""A ROS 2 node that maps radio nodes while a robot drives, and proposes where to listen next.

``python3 ros2_mapper.py --ros-args -p pose_topic:=/odom -p pose_type:=odometry``

ROS has no standard message for a radio packet. This node reads std_msgs/String with JSON such as
``{"node": "n7", "rssi_dbm": -71.5}``, and takes the time at which it arrives, by the clock of the node.
"""

from __future__ import annotations

import json
import math
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from live_map import REGION_95, LiveMap, Place
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

import sextant

#: The variance of what is not known (m² or rad²).
UNKNOWN = 1e6
#: The axis of an ellipse is at least this long (m), so that it can be seen.
LEAST_AXIS_M = 0.02

POSE_TYPES = {"pose": PoseStamped, "odometry": Odometry}


class Ros2Mapper(Node):
    """Subscribes to poses and packets; publishes the map and a goal."""

    def __init__(self) -> None:
        super().__init__("sextant_mapper")
        self.pose_type = self._parameter("pose_type", "pose")
        if self.pose_type not in POSE_TYPES:
            raise ValueError(f"pose_type is {self.pose_type!r}; allowed: {', '.join(POSE_TYPES)}")
        self.live = LiveMap(algorithm=self._parameter("algorithm", "auto"))
        self.frame = self._parameter("frame_id", "")
        self.markers = self.create_publisher(MarkerArray, "map_of_nodes", 10)
        self.goal = self.create_publisher(PoseStamped, self._parameter("goal_topic", "next_stop"), 10)
        self.poses: dict[str, Any] = {}
        pose_topic = self._parameter("pose_topic", "pose")
        self.create_subscription(POSE_TYPES[self.pose_type], pose_topic, self.on_pose, 50)
        self.create_subscription(String, self._parameter("packet_topic", "packets"), self.on_packet, 200)
        self.create_timer(self._parameter("period_s", 10.0), self.on_timer)

    def on_pose(self, message: Any) -> None:
        """Add a pose. Poses in another frame than that of the map are left out.

        The frame of the map is the parameter ``frame_id``; if it is empty, the frame of the first pose.
        """
        frame = message.header.frame_id
        self.frame = self.frame or frame
        if frame != self.frame:
            self.get_logger().warning(f"a pose in frame {frame!r} is left out: the map is in frame {self.frame!r}")
            return
        at = (message.pose.pose if self.pose_type == "odometry" else message.pose).position
        stamp = message.header.stamp
        t_s = stamp.sec + stamp.nanosec * 1e-9
        try:
            added = self.live.add_pose(t_s, at.x, at.y, at.z)
        except ValueError as error:
            self.get_logger().warning(f"a pose is left out: {error}")
            return
        if not added:
            self.get_logger().warning(f"the pose of {t_s} s is left out: it is not later than the last")

    def on_packet(self, message: Any) -> None:
        """Add a packet."""
        try:
            packet = json.loads(message.data)
            node, rssi_dbm = str(packet["node"]), float(packet["rssi_dbm"])
            self.live.add_packet(self.get_clock().now().nanoseconds * 1e-9, node, rssi_dbm)
        except (ValueError, KeyError, TypeError) as error:
            self.get_logger().warning(
                f'a packet is left out: {message.data!r} ({error!r}); expected {{"node": "n7", "rssi_dbm": -71.5}}'
            )

    def on_timer(self) -> None:
        """Map what was heard until now, and publish it."""
        try:
            places = self.live.map()
        except sextant.SextantError as error:
            self.get_logger().warning(f"no map yet: {error}")
            return
        if not places:
            self.get_logger().warning(f"no map yet: {self.live.missing() or 'no node has a place'}")
            return
        self.markers.publish(self._marker_array(places))
        for place in places:
            if place.has_covariance:
                self._publisher_of(place.node).publish(self._pose_with_covariance(place))
        stop = self.live.next_stop(places)
        if stop is not None:
            self.goal.publish(self._goal(stop))

    def _parameter(self, name: str, default: Any) -> Any:
        return self.declare_parameter(name, default).value

    def _publisher_of(self, node: str) -> Any:
        """The publisher of one node; a character that no topic may have becomes its number: `a-b` is `a_2d_b`."""
        if node not in self.poses:
            word = "".join(letter if letter.isascii() and letter.isalnum() else f"_{ord(letter):x}_" for letter in node)
            self.poses[node] = self.create_publisher(PoseWithCovarianceStamped, f"nodes/node_{word}", 10)
        return self.poses[node]

    def _stamp(self, message: Any) -> None:
        message.header.frame_id = self.frame
        message.header.stamp = self.get_clock().now().to_msg()

    def _marker_array(self, places: list[Place]) -> Any:
        array = MarkerArray()
        for index, place in enumerate(sorted(places, key=lambda one: one.node)):
            array.markers.append(self._marker("place", index, place, Marker.SPHERE, (0.2, 0.2, 0.2), 0.0, 1.0))
            if place.has_covariance:
                long_m, short_m, direction = place.axes()
                widths = [max(LEAST_AXIS_M, 2.0 * REGION_95 * axis) for axis in (long_m, short_m)]
                size = (widths[0], widths[1], LEAST_AXIS_M)
                array.markers.append(self._marker("region_95", index, place, Marker.CYLINDER, size, direction, 0.25))
        return array

    def _marker(
        self,
        namespace: str,
        index: int,
        place: Place,
        kind: int,
        size_m: tuple[float, float, float],
        direction_rad: float,
        opacity: float,
    ) -> Any:
        marker = Marker()
        self._stamp(marker)
        marker.ns, marker.id, marker.type, marker.action = namespace, index, kind, Marker.ADD
        _put(marker.pose.position, place.x_m, place.y_m, place.z_m)
        marker.pose.orientation.z = math.sin(direction_rad / 2.0)
        marker.pose.orientation.w = math.cos(direction_rad / 2.0)
        _put(marker.scale, *size_m)
        marker.color.r, marker.color.g, marker.color.b, marker.color.a = 0.1, 0.4, 0.9, opacity
        return marker

    def _pose_with_covariance(self, place: Place) -> Any:
        message = PoseWithCovarianceStamped()
        self._stamp(message)
        _put(message.pose.pose.position, place.x_m, place.y_m, place.z_m)
        message.pose.pose.orientation.w = 1.0
        # Rows and columns are x, y, z and three rotations; only x and y are estimated here, the others are not known.
        covariance = [UNKNOWN if row == column and row > 1 else 0.0 for row in range(6) for column in range(6)]
        covariance[0], covariance[1], covariance[6], covariance[7] = place.xx_m2, place.xy_m2, place.xy_m2, place.yy_m2
        message.pose.covariance = covariance
        return message

    def _goal(self, stop: tuple[float, float]) -> Any:
        message = PoseStamped()
        self._stamp(message)
        _put(message.pose.position, *stop, 0.0)
        message.pose.orientation.w = 1.0
        return message


def _put(vector: Any, x: float, y: float, z: float) -> None:
    vector.x, vector.y, vector.z = float(x), float(y), float(z)


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    node = Ros2Mapper()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
