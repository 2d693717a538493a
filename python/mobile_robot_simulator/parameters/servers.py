"""WorldParameters and MapParameters: the parameters of the world server and of the map server."""

# Annotations are objects here, not texts: pydantic would have to compile each text, which takes 1.5 ms for all parameters.

from typing import Annotated

from pydantic import BeforeValidator, Field

from .model import Parameters
from .values import Name, OptionalTopic, Rate, Topic, names_of


def _check_faults(texts: object) -> object:
    """Rejects what is not a list of texts."""
    if not (isinstance(texts, list | tuple) and all(isinstance(text, str) for text in texts)):
        raise ValueError("""Input should be a list of texts such as ["Drop('/scan', probability=0.1)"]""")
    return texts


class WorldParameters(Parameters):
    """Parameters of the world of a ROS process, in which all of its robots move."""

    node_name = "world_server"

    robots: Annotated[tuple[str, ...], BeforeValidator(names_of("robot1", "robot2"))] = Field(
        (), description="names of several robots, each in a namespace of its name; empty for one robot without a name"
    )
    faults: Annotated[tuple[str, ...], BeforeValidator(_check_faults)] = Field(
        (), description="faults of the process, each as a text such as Drop('/scan', probability=0.1)"
    )
    obstacles_topic: Topic = Field("obstacles", description="topic of markers that add, move and remove obstacles")
    markers_topic: OptionalTopic = Field(
        "markers", description="topic of markers that show robots, obstacles and contacts in RViz; empty for none"
    )
    markers_rate: Rate = Field(5.0, description="rate of these markers [Hz]")
    map_frame_id: Name = Field("map", description="frame of the map")


class MapParameters(Parameters):
    """Parameters of `MapFileServer`, with the names of nav2_map_server."""

    node_name = "map_server"

    yaml_filename: Name = Field(description="path of the map_server YAML file of the map")
    topic_name: Topic = Field("map", description="topic of the map")
    service_name: Topic = Field("static_map", description="name of the GetMap service")
    frame_id: Name = Field("map", description="frame of the map")
