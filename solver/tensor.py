"""Tables of bases that are products of weights in x and in y: three by three or four by four support nodes."""

from mpm_verify.solver._jit import BLOCK, kernel


@kernel(inline=True)
def product(k, K, b, number, Nx, Ny, Gx, Gy, table, node):
    """Write one row of the table: N = Nx Ny, dN = (Gx Ny, Nx Gy)."""
    node[k * BLOCK + b] = number
    table[k * BLOCK + b] = Nx * Ny
    table[(K + k) * BLOCK + b] = Gx * Ny
    table[(2 * K + k) * BLOCK + b] = Nx * Gy


@kernel(inline=True)
def three(k, K, b, first, Nx, Gx, Y0, Y1, Y2, D0, D1, D2, table, node):
    """Write three nodes of one column, upwards from `first`; values Y and slopes D in y."""
    product(k, K, b, first, Nx, Y0, Gx, D0, table, node)
    product(k + 1, K, b, first + 1, Nx, Y1, Gx, D1, table, node)
    product(k + 2, K, b, first + 2, Nx, Y2, Gx, D2, table, node)


@kernel(inline=True)
def four(k, K, b, first, Nx, Gx, Y0, Y1, Y2, Y3, D0, D1, D2, D3, table, node):
    """Write four nodes of one column."""
    three(k, K, b, first, Nx, Gx, Y0, Y1, Y2, D0, D1, D2, table, node)
    product(k + 3, K, b, first + 3, Nx, Y3, Gx, D3, table, node)
