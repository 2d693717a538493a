"""Learning: navigation among walls as environments of Gymnasium, one at a time or thousands together, or of PettingZoo.

Importing this package registers `mobile_robot_simulator/Navigation-v0` with Gymnasium. It needs the extra `learning`.

Example:
    >>> import gymnasium
    >>> import mobile_robot_simulator.learning
    >>> envs = gymnasium.make_vec("mobile_robot_simulator/Navigation-v0", num_envs=64)
    >>> observations, info = envs.reset(seed=1)
    >>> observations["ranges"].shape, observations["goal"].shape, observations["velocity"].shape
    ((64, 64), (64, 2), (64, 2))
"""

from typing import TYPE_CHECKING, Any

try:
    import gymnasium
except ImportError as error:
    raise ImportError("learning needs gymnasium: pip install 'mobile-robot-simulator[learning]'") from error

from .environment import NavigationEnv
from .free_space import FreeSpace
from .plans import training_plans, unseen_plans
from .task import NavigationTask
from .vector_environment import NavigationVectorEnv

if TYPE_CHECKING:
    from .parallel_environment import NavigationParallelEnv

__all__ = [
    "FreeSpace",
    "NavigationEnv",
    "NavigationParallelEnv",
    "NavigationTask",
    "NavigationVectorEnv",
    "training_plans",
    "unseen_plans",
]


def __getattr__(name: str) -> Any:
    """Imports the environment of PettingZoo when it is first used."""
    if name == "NavigationParallelEnv":
        from .parallel_environment import NavigationParallelEnv

        return NavigationParallelEnv
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


gymnasium.register(
    "mobile_robot_simulator/Navigation-v0",
    entry_point=f"{__name__}:NavigationEnv",
    vector_entry_point=f"{__name__}:NavigationVectorEnv",
)
