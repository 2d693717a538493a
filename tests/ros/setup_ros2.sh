#!/usr/bin/env bash
# Creates a virtual environment with ROS 2 (Kilted over Fast DDS) from PyPI. Also builds the types that PyPI has no wheels
# for: the messages of tf2 and of ackermann_msgs, and the services of nav2_msgs and simulation_interfaces (version 2) that the
# nodes offer.
# Usage: setup_ros2.sh VENV. Needs g++ and CPython 3.10 to 3.13: $PYTHON, or any that is found. cmake comes from PyPI.
set -euo pipefail
venv=$(realpath -m "$1")
command -v g++ >/dev/null || { echo "ROS 2 needs g++ to build messages; g++ was not found" >&2; exit 1; }
python=
fits='import ensurepip, sys, venv; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 13))'
for candidate in "${PYTHON:-python3}" python3 /usr/bin/python3 python3.1{3,2,1,0}; do
    if "$candidate" -c "$fits" 2>/dev/null; then
        python=$candidate
        break
    fi
done
[ -n "$python" ] || { echo "ROS 2 from PyPI needs CPython 3.10 to 3.13 with venv; none was found" >&2; exit 1; }
rm -rf "$venv"
"$python" -m venv "$venv"
install() { "$venv/bin/python" -m pip install --quiet --disable-pip-version-check "$@"; }

install 'ros-rclpy[fastrtps]==9.1.2' ros-{geometry,nav,sensor,visualization}-msgs==5.5.1 ros-std-srvs==5.5.1 ros-rosgraph-msgs==2.3.0
# The generators, and the dependencies that their packages do not declare.
ament=(core export-{definitions,dependencies,include-directories,interfaces,libraries,link-flags,targets} gen-version-h gmock
    gtest include-directories libraries pytest python ros ros-core target-dependencies test version)
install cmake ros-rosidl-{default,core}-generators ros-ament-package ros-python-cmake-module catkin_pkg \
    ros-{gtest,gmock}-vendor ros-ament-cmake "${ament[@]/#/ros-ament-cmake-}"

# The CMake files of the generators contain paths of the Python that they were built with.
read -r tag name include < <("$venv/bin/python" -c '
import sys, sysconfig
print("cp%d%d" % sys.version_info[:2], "python%d.%d" % sys.version_info[:2], sysconfig.get_path("include"))')
grep -rl --include='*.cmake' /opt/python/ "$venv/share" | xargs sed -i \
    -e "s#/opt/python/$tag-$tag/include/$name#$include#g" \
    -e "s#/opt/python/$tag-$tag/lib/$name/site-packages#$venv/lib/$name/site-packages#g"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export PATH="$venv/bin:$PATH" AMENT_PREFIX_PATH=$venv CMAKE_PREFIX_PATH=$venv

# Builds and installs a package of interfaces. Usage: build PACKAGE [FILE CONTENT_OF_FILE] ...
build() {
    local source=$scratch/$1 package=$1 files=()
    shift
    while [ $# -gt 0 ]; do
        mkdir -p "$source/$(dirname "$1")"
        printf '%s\n' "$2" >"$source/$1"
        files+=("$1")
        shift 2
    done
    cat >"$source/package.xml" <<XML
<package format="3">
  <name>$package</name> <version>0.0.0</version> <description>${files[*]}</description>
  <maintainer email="nobody@example.com">nobody</maintainer> <license>BSD-3-Clause</license>
  <buildtool_depend>ament_cmake</buildtool_depend> <buildtool_depend>rosidl_default_generators</buildtool_depend>
  <depend>geometry_msgs</depend> <depend>std_msgs</depend> <exec_depend>rosidl_default_runtime</exec_depend>
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
XML
    cat >"$source/CMakeLists.txt" <<CMAKE
cmake_minimum_required(VERSION 3.20)
project($package)
find_package(ament_cmake REQUIRED)
find_package(geometry_msgs REQUIRED)
find_package(std_msgs REQUIRED)
find_package(rosidl_default_generators REQUIRED)
rosidl_generate_interfaces(\${PROJECT_NAME} ${files[@]} DEPENDENCIES geometry_msgs std_msgs)
ament_package()
CMAKE
    {
        cmake -S "$source" -B "$source/build" -DCMAKE_INSTALL_PREFIX="$venv" -DCMAKE_BUILD_TYPE=Release \
            -DBUILD_TESTING=OFF -DPython3_EXECUTABLE="$venv/bin/python" &&
            cmake --build "$source/build" -j2 && cmake --install "$source/build"
    } >"$source/log" 2>&1 || { tail -n 20 "$source/log" >&2; return 1; }
}
build tf2_msgs msg/TFMessage.msg 'geometry_msgs/TransformStamped[] transforms'
build ackermann_msgs \
    msg/AckermannDrive.msg $'float32 steering_angle\nfloat32 steering_angle_velocity
float32 speed\nfloat32 acceleration\nfloat32 jerk' \
    msg/AckermannDriveStamped.msg $'std_msgs/Header header\nAckermannDrive drive'
build nav2_msgs srv/SetInitialPose.srv 'geometry_msgs/PoseWithCovarianceStamped pose
---'
build simulation_interfaces \
    msg/Result.msg $'uint8 result\nstring error_message' \
    msg/Resource.msg $'string uri\nstring resource_string' \
    msg/EntityState.msg $'std_msgs/Header header
geometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Accel acceleration' \
    srv/SpawnEntity.srv $'string name\nbool allow_renaming\nResource entity_resource\nstring entity_namespace
geometry_msgs/PoseStamped initial_pose\n---\nResult result\nstring entity_name' \
    srv/DeleteEntity.srv $'string entity\n---\nResult result' \
    srv/SetEntityState.srv $'string entity\nEntityState state
bool set_pose\nbool set_twist\nbool set_acceleration\n---\nResult result'
"$venv/bin/python" -c 'import rclpy, tf2_msgs.msg as m, ackermann_msgs.msg as a, nav2_msgs.srv as s
import simulation_interfaces.srv as e
m.TFMessage(); a.AckermannDriveStamped(); s.SetInitialPose.Request(); e.SpawnEntity.Request()'
