"""What the package offers, one line each, and where it is made."""

from surae.model.geometry_file import read_geometry as read_geometry
from surae.model.geometry_table import GeometryTable as GeometryTable
from surae.model.joint import Joint as Joint
from surae.model.joint import read_joint as read_joint
from surae.model.options import ModelOptions as ModelOptions
from surae.model.parameter import Parameter as Parameter
from surae.model.parameter import adapted as adapted
from surae.model.recorded_model import Simulator as Simulator
from surae.model.registry import MODELS as MODELS
from surae.model.registry import ModelSpec as ModelSpec
from surae.model.registry import check_names as check_names
from surae.model.registry import check_value as check_value
from surae.model.registry import get_model as get_model
from surae.model.registry import with_optional as with_optional
from surae.model.simulator import TendonLaw as TendonLaw
from surae.model.simulator import TendonState as TendonState
from surae.model.simulator import TorqueParts as TorqueParts
from surae.model.simulator import check_finite_torque as check_finite_torque
