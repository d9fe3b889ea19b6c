"""What a user who made a mistake should have written, in the words of the user's own line."""

from .errors import for_exception as for_exception
from .errors import for_made as for_made
from .errors import for_missing as for_missing
from .errors import for_no_vector as for_no_vector
from .errors import for_number as for_number
from .errors import for_operator_here as for_operator_here
from .names import for_class as for_class
from .names import for_function as for_function
