"""The class ViewFactors, apart because it needs scipy."""
import scipy.sparse


class ViewFactors(scipy.sparse.csr_matrix):
    """View factors: F[i, j] is the share of what surface i radiates that reaches surface j without a bounce.

    What is computed from it, as 2 * F or F[:3], has none of the attributes below.
    """

    names = ()  # of the surfaces
    areas = None  # [m^2], (n,)
    error = None  # of each factor, estimated, (n, n)
    closed = None  # whether every row sums to 1
