"""exp, ln, pow, gamma, sine and cosine from + - * / alone (docs/bits.md, Functions). A double-double is a tuple (hi, lo)."""
import math
import struct

H = float.fromhex
LOG_2 = (H('0x1.62e42fefa39efp-1'), H('0x1.abc9e3b39803fp-56'))
TWO_PI = (H('0x1.921fb54442d18p+2'), H('0x1.1a62633145c07p-52'))
HALF_LOG_TWO_PI = (H('0x1.d67f1c864beb5p-1'), H('-0x1.65b5a1b7ff5dfp-55'))
THIRD = (H('0x1.5555555555555p-2'), H('0x1.5555555555555p-56'))


def scaled(number, factor):
    """A constant times a power of two, which is exact."""
    return (number[0] * factor, number[1] * factor)


def nearest_pair(numerator, denominator):
    """The double nearest to a quotient of whole numbers, and the double nearest to the rest."""
    hi = numerator / denominator
    n, d = hi.as_integer_ratio()
    rest = numerator * d - n * denominator
    return (hi, rest / (denominator * d))


def bits_of(x):
    return struct.unpack('<Q', struct.pack('<d', x))[0]


def from_bits(bits):
    return struct.unpack('<d', struct.pack('<Q', bits))[0]


def quick_two_sum(a, b):
    s = a + b
    return (s, b - (s - a))


def two_sum(a, b):
    s = a + b
    t = s - a
    return (s, (a - (s - t)) + (b - t))


def two_product(a, b):
    splitter = 134217729.0
    p = a * b
    ta, tb = splitter * a, splitter * b
    ah, bh = ta - (ta - a), tb - (tb - b)
    al, bl = a - ah, b - bh
    return (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)


def add(a, b):
    s = two_sum(a[0], b[0])
    return quick_two_sum(s[0], s[1] + (a[1] + b[1]))


def add_double(a, b):
    s = two_sum(a[0], b)
    return quick_two_sum(s[0], s[1] + a[1])


def multiply(a, b):
    p = two_product(a[0], b[0])
    return quick_two_sum(p[0], p[1] + (a[0] * b[1] + a[1] * b[0]))


def multiply_double(a, b):
    p = two_product(a[0], b)
    return quick_two_sum(p[0], p[1] + a[1] * b)


def divide(a, b):
    q = a[0] / b[0]
    p = multiply_double(b, q)
    return quick_two_sum(q, (((a[0] - p[0]) - p[1]) + a[1]) / b[0])


def tail_of(x, coefficients):
    """Horner's rule in double: ((c0 x + c1) x + c2) ..."""
    tail = coefficients[0]
    for c in coefficients[1:]:
        tail = tail * x + c
    return tail


def series(x, tail, constants):
    """(((c0 + tail x) x + c1) x + c2) ..., in double-double; the first constant takes up the tail."""
    total = add_double(constants[0], tail * x[0])
    for c in constants[1:]:
        product = multiply(total, x)
        total = add(product, c) if isinstance(c, tuple) else add_double(product, c)
    return total


def log_pair(x):
    """ln x (ln) of a normal x > 0, before the last rounding."""
    low = bits_of(H('0x1.6a09e667f3bcdp-1'))
    u = bits_of(x) + bits_of(1.0) - low
    exponent = (u >> 52) - 1023
    m = from_bits((u & (1 << 52) - 1) + low)
    s = divide((m - 1.0, 0.0), two_sum(m, 1.0))
    z = multiply(s, s)
    tail = tail_of(z[0], [1.0 / n for n in range(33, 9, -2)])
    total = series(z, tail, [nearest_pair(1, n) for n in (9, 7, 5, 3)])
    twice = (2.0 * s[0], 2.0 * s[1])
    log_m = add(twice, multiply(twice, multiply(total, z)))
    return log_m if exponent == 0 else add(multiply_double(LOG_2, float(exponent)), log_m)


def exp_pair(x):
    """e^x = value 2^k (exp), before the last rounding: (value, k)."""
    big = 1.5 * 2.0**52
    n = (x[0] * H('0x1.71547652b82fep+0') + big) - big
    a = two_sum(x[0], -(n * H('0x1.62e42feep-1')))
    b = two_sum(a[0], -(n * H('0x1.a39ef356p-33')))
    r = quick_two_sum(b[0], (b[1] + (a[1] + x[1])) - n * H('0x1.93c7673007e5fp-65'))
    u = scaled(r, 0.0625)
    tail = tail_of(u[0], [1.0 / math.factorial(i) for i in range(11, 4, -1)])
    total = series(u, tail, [nearest_pair(1, 24), nearest_pair(1, 6), 0.5, 1.0])
    p = multiply(total, u)
    for _ in range(4):
        p = add(scaled(p, 2.0), multiply(p, p))
    return add_double(p, 1.0), int(n)


def exp(x):
    """e^x for -700 < x < 700."""
    value, k = exp_pair((x, 0.0))
    return value[0] * 2.0**k


def power(x, y):
    """x^y for x > 0 and a result within 10^+-300."""
    if y == 0.0 or x == 1.0:
        return 1.0
    value, k = exp_pair(multiply_double(log_pair(x), y))
    return value[0] * 2.0**k


def gamma(x):
    """Gamma(x) for 1 <= x <= 3."""
    z, product = (x, 0.0), (1.0, 0.0)
    while z[0] < 20.0:
        product = multiply(product, z)
        z = add_double(z, 1.0)
    inverse = divide((1.0, 0.0), z)
    w = multiply(inverse, inverse)
    tail = tail_of(w[0], [-174611.0 / 125400.0, 43867.0 / 244188.0, -3617.0 / 122400.0, 1.0 / 156.0, -691.0 / 360360.0,
                          1.0 / 1188.0, -1.0 / 1680.0, 1.0 / 1260.0])
    total = multiply(series(w, tail, [nearest_pair(-1, 360), nearest_pair(1, 12)]), inverse)
    log_z = add_double(log_pair(z[0]), z[1] / z[0])
    e = multiply(add_double(z, -0.5), log_z)
    e = add(e, (-z[0], -z[1]))
    e = add(add(e, HALF_LOG_TWO_PI), total)
    value, k = exp_pair(e)
    value = divide(value, product)
    shift = (bits_of(value[0]) >> 52) - 1023
    return (value[0] * 2.0**-shift) * 2.0**(k + shift)


def octant(a, factorials, constants):
    z = multiply(a, a)
    signs = [(-1.0)**i for i in range(len(factorials))]
    tail = tail_of(z[0], [s / math.factorial(f) for s, f in zip(signs, factorials)])
    return series(z, tail, constants), z


def sine_of_octant(a):
    total, z = octant(a, range(25, 8, -2), [nearest_pair(-1, 5040), nearest_pair(1, 120), nearest_pair(-1, 6)])
    return add(a, multiply(a, multiply(total, z)))[0]


def cosine_of_octant(a):
    total, z = octant(a, range(24, 7, -2), [nearest_pair(-1, 720), nearest_pair(1, 24), -0.5])
    return add_double(multiply(total, z), 1.0)[0]


def sine_of_turns(t, quarters=0):
    """sin(2 pi t) for 0 <= t < 1, advanced by some quarter turns: cos(2 pi t) by one."""
    big = 1.5 * 2.0**52
    n = (4.0 * t + big) - big
    r = t - 0.25 * n
    quarters += int(n)
    a = multiply_double(TWO_PI, r)
    result = cosine_of_octant(a) if quarters & 1 else sine_of_octant(a)
    return (-result if quarters & 2 else result) + 0.0
