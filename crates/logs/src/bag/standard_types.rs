//! The definitions of the messages that give a path, for bags that have none: ROS 2 wrote none into SQLite before Iron.

/// Types and what they hold (packages std_msgs, geometry_msgs, nav_msgs, sensor_msgs and tf2_msgs of ROS 2; constants left out).
const TYPES: [(&str, &str); 15] = [
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"),
    ("geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"),
    ("geometry_msgs/PoseWithCovarianceStamped", "std_msgs/Header header\ngeometry_msgs/PoseWithCovariance pose\n"),
    ("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"),
    ("geometry_msgs/TwistWithCovariance", "geometry_msgs/Twist twist\nfloat64[36] covariance\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    (
        "nav_msgs/Odometry",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
         geometry_msgs/TwistWithCovariance twist\n",
    ),
    ("tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"),
    (
        "sensor_msgs/NavSatFix",
        "std_msgs/Header header\nsensor_msgs/NavSatStatus status\nfloat64 latitude\nfloat64 longitude\nfloat64 altitude\n\
         float64[9] position_covariance\nuint8 position_covariance_type\n",
    ),
];

/// The status of a fix, which is of its own package too.
const STATUS: (&str, &str) = ("sensor_msgs/NavSatStatus", "int8 status\nuint16 service\n");

/// The definition of the messages of type `name` (`nav_msgs/msg/Odometry`) with all that they hold; `None` if it is not a type
/// of a path.
pub(super) fn definition(name: &str) -> Option<String> {
    let short = name.replace("/msg/", "/");
    let find = |name: &str| TYPES.iter().chain([&STATUS]).find(|(of, _)| *of == name);
    let (_, text) = find(&short)?;
    let mut whole = (*text).to_owned();
    let mut seen = vec![short];
    let mut at = 0;
    // Each type that the text names follows it once, so the text grows while it is read.
    while let Some(line) = whole[at..].find('\n').map(|end| whole[at..at + end].to_owned()) {
        at += line.len() + 1;
        let of = line.split(['[', ' ']).next().unwrap_or_default();
        if let Some((of, text)) = find(of).filter(|_| !seen.iter().any(|seen| seen == of)) {
            seen.push((*of).to_owned());
            whole.push_str("===\nMSG: ");
            whole.push_str(of);
            whole.push('\n');
            whole.push_str(text);
        }
    }
    Some(whole)
}

#[cfg(test)]
mod tests {
    use super::super::definition::{Definitions, Dialect};
    use super::super::leaves::listing;
    use super::*;

    #[test]
    fn the_types_of_paths_are_known_with_all_that_they_hold() {
        for (name, field) in [
            ("nav_msgs/msg/Odometry", "pose.pose.position.x (float64)"),
            ("geometry_msgs/msg/PoseStamped", "pose.position.z (float64)"),
            ("geometry_msgs/msg/PoseWithCovarianceStamped", "pose.pose.orientation.w (float64)"),
            ("tf2_msgs/msg/TFMessage", "transforms[].transform.rotation.w (float64)"),
            ("sensor_msgs/msg/NavSatFix", "status.status (int8)"),
        ] {
            let text = definition(name).unwrap();
            let fields = listing(&Definitions::parse(Dialect::Ros2, name, &text).unwrap());
            assert!(fields.contains(field) && fields.contains("header.stamp"), "{fields}");
        }
        assert_eq!(definition("radio_msgs/msg/Heard"), None);
    }
}
