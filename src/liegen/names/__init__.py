"""Names: what languages and headers keep for themselves, what is derived of a factor's names, the checks."""

from .check import check_arguments as check_arguments
from .check import check_definition as check_definition
from .check import check_factor_name as check_factor_name
from .check import check_outputs as check_outputs
from .check import complaint as complaint
from .check import macro as macro
from .check import refuse as refuse
from .check import reserved as reserved
from .check import shown as shown
from .derived import SQRT_INFO as SQRT_INFO
from .derived import block_name as block_name
from .derived import gradient_name as gradient_name
from .derived import jacobian_name as jacobian_name
from .headers import taken as taken
from .keywords import KEYWORDS as KEYWORDS
from .keywords import OWN_C as OWN_C
from .keywords import OWN_NUMPY as OWN_NUMPY
from .keywords import PACKAGE_SYMBOLS as PACKAGE_SYMBOLS
