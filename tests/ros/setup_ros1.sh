#!/usr/bin/env bash
# Installs ROS 1 from Debian packages and creates a virtual environment for it. Also generates the types of
# ackermann_msgs, robot_localization and gazebo_msgs that the nodes use, because Debian has no packages of them.
# Usage: setup_ros1.sh VENV. Needs Debian 12 or a derivative, and root or sudo.
set -euo pipefail
venv=$(realpath -m "$1")
packages=(ros-core rosbash python3-{genpy,roslaunch,rospy,rosbag,rostopic,rosservice,rosparam,tf2-ros,nav-msgs,sensor-msgs,std-srvs,visualization-msgs}
    ros-{nav,sensor,visualization}-msgs ros-std-srvs ros-robot-state-publisher python3-venv)
if ! dpkg-query -W "${packages[@]}" >/dev/null 2>&1; then
    root=()
    [ "$(id -u)" -eq 0 ] || root=(sudo)
    for command in apt-get "${root[@]}"; do
        command -v "$command" >/dev/null && continue
        echo "ROS 1 needs Debian 12 or a derivative, and root or sudo; $command was not found" >&2
        exit 1
    done
    export DEBIAN_FRONTEND=noninteractive
    "${root[@]}" apt-get update -qq
    "${root[@]}" apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
fi

rm -rf "$venv"
/usr/bin/python3 -m venv "$venv"
site=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')

source=$(mktemp -d)
trap 'rm -rf "$source"' EXIT
shared=(-I geometry_msgs:/usr/share/geometry_msgs/msg -I std_msgs:/usr/share/std_msgs/msg -I "gazebo_msgs:$source/gazebo_msgs/msg"
    -I "ackermann_msgs:$source/ackermann_msgs/msg")

# Generates the Python module of an interface. Usage: generate PACKAGE msg|srv NAME CONTENT_OF_FILE
generate() {
    local package=$1 kind=$2 target=$site/$1/$2 file=$source/$1/$2/$3.$2
    mkdir -p "$target" "$(dirname "$file")"
    touch "$site/$package/__init__.py"
    printf '%s\n' "$4" >"$file"
    /usr/bin/python3 "/usr/lib/genpy/gen${kind}_py.py" -p "$package" -o "$target" "${shared[@]}" "$file"
    /usr/bin/python3 "/usr/lib/genpy/gen${kind}_py.py" -p "$package" -o "$target" --initpy
}
generate ackermann_msgs msg AckermannDrive $'float32 steering_angle\nfloat32 steering_angle_velocity
float32 speed\nfloat32 acceleration\nfloat32 jerk'
generate ackermann_msgs msg AckermannDriveStamped $'Header header\nAckermannDrive drive'
generate robot_localization srv SetPose $'geometry_msgs/PoseWithCovarianceStamped pose\n---'
generate gazebo_msgs msg ModelState $'string model_name\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\nstring reference_frame'
answer=$'---\nbool success\nstring status_message'
generate gazebo_msgs srv SpawnModel $'string model_name\nstring model_xml\nstring robot_namespace\ngeometry_msgs/Pose initial_pose
string reference_frame\n'"$answer"
generate gazebo_msgs srv SetModelState $'gazebo_msgs/ModelState model_state\n'"$answer"
generate gazebo_msgs srv DeleteModel $'string model_name\n'"$answer"
