"""Pictures of grids, scans and drives: in Matplotlib axes, or as PNG, PDF and SVG files.

`GridPicture`, `ScanPicture` and `DrivePicture` hold what to draw. They draw it in Matplotlib axes or save it to a file.
Saving needs no display and does not import pyplot. The same picture gives the same file, byte for byte, with the same
version of Matplotlib.
"""

try:
    import matplotlib.figure  # noqa: F401
except ImportError as error:
    raise ImportError("pictures need matplotlib: pip install 'mobile-robot-simulator[plotting]'") from error

from .drive import DrivePicture
from .grid import GridPicture, grid_png, plot_grid
from .picture import Picture
from .residuals import ResidualPicture
from .scan import ScanPicture

__all__ = [
    "DrivePicture",
    "GridPicture",
    "Picture",
    "ResidualPicture",
    "ScanPicture",
    "grid_png",
    "plot_grid",
]
