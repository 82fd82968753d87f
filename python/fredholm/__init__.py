"""Fredholm: deterministic fields on the surfaces of a scene, x = b + K x.

A scene of diffuse surfaces is loaded or built, solved to an accuracy, and looked at:

>>> import fredholm
>>> scene = fredholm.Scene.load("scenes/occluder.toml")
>>> solution = scene.solve(accuracy=0.01)
>>> solution["floor"].irradiance
array([...])

Lengths are in metres, areas in m², irradiance, radiosity and exitance in W/m². Arrays have the
bands of the light in their last axis. A face is lit on the side from which its corners run
counter-clockwise. Waves have the time factor exp(+jωt).

Nothing but NumPy is needed. SciPy, pandas, xarray, PyVista and tqdm are used where they are
installed and asked for.
"""

from . import solvers
from ._core import VERSION as __version__
from ._coupling import Coupling, Couplings
from ._errors import (
    FileError,
    FredholmError,
    FredholmWarning,
    InputError,
    Interrupted,
    NotConvergedError,
    ResourceError,
)
from ._scene import Material, Scene, Surface
from ._solution import Faces, Solution, SurfaceLight
from ._studies import (
    Check,
    Comparison,
    Convergence,
    Crosscheck,
    Judgement,
    Methods,
    Reference,
    Spectrum,
    Study,
    Trace,
    judge,
)
from ._viewfactors import ViewFactors, view_factor_methods, view_factors
from ._waves import FarField, Monostatic, NearField, Waves, WaveScene

__all__ = [
    "Check",
    "Comparison",
    "Convergence",
    "Coupling",
    "Couplings",
    "Crosscheck",
    "Faces",
    "FarField",
    "FileError",
    "FredholmError",
    "FredholmWarning",
    "InputError",
    "Interrupted",
    "Judgement",
    "Material",
    "Methods",
    "Monostatic",
    "NearField",
    "NotConvergedError",
    "Reference",
    "ResourceError",
    "Scene",
    "Solution",
    "Spectrum",
    "Study",
    "Surface",
    "SurfaceLight",
    "Trace",
    "ViewFactors",
    "WaveScene",
    "Waves",
    "__version__",
    "judge",
    "solvers",
    "view_factor_methods",
    "view_factors",
]
