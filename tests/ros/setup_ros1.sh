#!/usr/bin/env bash
# Installs ROS 1 from Debian packages and creates a virtual environment for it. Also generates the one service type of
# robot_localization that the robot offers, because Debian has no package of it.
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
mkdir -p "$site/robot_localization/srv"
touch "$site/robot_localization/__init__.py"
printf 'geometry_msgs/PoseWithCovarianceStamped pose\n---\n' >"$source/SetPose.srv"
generate() { /usr/bin/python3 /usr/lib/genpy/gensrv_py.py -p robot_localization -o "$site/robot_localization/srv" "$@"; }
generate -I geometry_msgs:/usr/share/geometry_msgs/msg -I std_msgs:/usr/share/std_msgs/msg "$source/SetPose.srv"
generate --initpy
