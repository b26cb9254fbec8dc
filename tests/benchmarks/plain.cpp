// Plain C++: a step of MPM and of CPDI as two loops, weights in registers, one thread, arrays laid out as the solver's.
// Compiled with -O3 -march=native by plain.py. No walls but nodes that are held at rest.
#include <algorithm>
#include <cmath>

using Index = long long;

struct Body {
    Index count, nodes, ny;
    double *x, *v, *F, *sigma;  // (P,2), (P,2), (P,4), (P,4)
    const double *m, *V0, *b, *half;  // (P,), (P,), (P,2), half side vectors (P,4)
    double x0, y0, inv_dx;
    double *mass, *given, *taken;  // (n,), momentum and force (n,4), velocity and acceleration (n,4)
    const bool *held;  // (n,2)
    double dt, cutoff, lam, mu;
};

struct Load { double m, px, py, bx, by, sxx, syy, sxy; };

static Load load(const Body &s, Index p) {
    const double *F = s.F + 4 * p, *sigma = s.sigma + 4 * p;
    const double m = s.m[p], V = s.V0[p] * (F[0] * F[3] - F[1] * F[2]);
    return {m, m * s.v[2 * p], m * s.v[2 * p + 1], m * s.b[2 * p], m * s.b[2 * p + 1],
            -V * sigma[0], -V * sigma[1], -V * sigma[3]};
}

static inline void give(const Body &s, Index i, double N, double gx, double gy, const Load &l) {
    double *given = s.given + 4 * i;
    s.mass[i] += N * l.m;
    given[0] += N * l.px;
    given[1] += N * l.py;
    given[2] += N * l.bx + (l.sxx * gx + l.sxy * gy);
    given[3] += N * l.by + (l.sxy * gx + l.syy * gy);
}

struct Sum { double vx, vy, ax, ay, Lxx, Lxy, Lyx, Lyy; };

static inline void take(const Body &s, Index i, double N, double gx, double gy, Sum &sum) {
    const double *node = s.taken + 4 * i;
    sum.vx += N * node[0];
    sum.vy += N * node[1];
    sum.ax += N * node[2];
    sum.ay += N * node[3];
    sum.Lxx += node[0] * gx;
    sum.Lxy += node[0] * gy;
    sum.Lyx += node[1] * gx;
    sum.Lyy += node[1] * gy;
}

static inline void move(const Body &s, Index p, const Sum &sum) {
    double *F = s.F + 4 * p, *sigma = s.sigma + 4 * p;
    s.x[2 * p] += s.dt * sum.vx;
    s.x[2 * p + 1] += s.dt * sum.vy;
    s.v[2 * p] += s.dt * sum.ax;
    s.v[2 * p + 1] += s.dt * sum.ay;
    const double xx = F[0] + s.dt * (sum.Lxx * F[0] + sum.Lxy * F[2]);
    const double xy = F[1] + s.dt * (sum.Lxx * F[1] + sum.Lxy * F[3]);
    const double yx = F[2] + s.dt * (sum.Lyx * F[0] + sum.Lyy * F[2]);
    const double yy = F[3] + s.dt * (sum.Lyx * F[1] + sum.Lyy * F[3]);
    F[0] = xx, F[1] = xy, F[2] = yx, F[3] = yy;
    const double J = xx * yy - xy * yx, per_J = 1.0 / J, shear = s.mu * per_J;
    const double bulk = s.lam * per_J * std::log(J) - shear;
    sigma[0] = shear * (xx * xx + xy * xy) + bulk;
    sigma[1] = shear * (yx * yx + yy * yy) + bulk;
    sigma[2] = shear + bulk;
    sigma[3] = shear * (xx * yx + xy * yy);
}

// Calls node(i, N, gx, gy) for the four nodes around a point in cells: hat times weight, and times (gx, gy).
template <class Node>
static inline void corner(const Body &s, double X, double Y, double w, double gx, double gy, Node node) {
    const Index i = static_cast<Index>(X), j = static_cast<Index>(Y), n = i * s.ny + j;
    const double r = X - i, a = Y - j;
    const double S[4] = {(1 - r) * (1 - a), (1 - r) * a, r * (1 - a), r * a};
    const Index at[4] = {n, n + 1, n + s.ny, n + s.ny + 1};
    for (int k = 0; k < 4; ++k) node(at[k], w * S[k], gx * S[k], gy * S[k]);
}

struct Hats {
    template <class Node> static inline void each(const Body &s, Index p, Node node) {
        const double X = (s.x[2 * p] - s.x0) * s.inv_dx, Y = (s.x[2 * p + 1] - s.y0) * s.inv_dx, h = s.inv_dx;
        const Index i = static_cast<Index>(X), j = static_cast<Index>(Y), n = i * s.ny + j;
        const double r = X - i, a = Y - j, q = 1 - r, c = 1 - a;
        node(n, q * c, -c * h, -q * h);
        node(n + 1, q * a, -a * h, q * h);
        node(n + s.ny, r * c, c * h, -r * h);
        node(n + s.ny + 1, r * a, a * h, r * h);
    }
};

struct Parallelogram {
    template <class Node> static inline void each(const Body &s, Index p, Node node) {
        const double *F = s.F + 4 * p, *r = s.half + 4 * p;
        const double r1x = F[0] * r[0] + F[1] * r[1], r1y = F[2] * r[0] + F[3] * r[1];
        const double r2x = F[0] * r[2] + F[1] * r[3], r2y = F[2] * r[2] + F[3] * r[3];
        const double per = 0.25 / (r1x * r2y - r1y * r2x), h = s.inv_dx;
        const double ax = (r1y - r2y) * per, ay = (r2x - r1x) * per, bx = (r1y + r2y) * per, by = -(r1x + r2x) * per;
        const double X = (s.x[2 * p] - s.x0) * h, Y = (s.x[2 * p + 1] - s.y0) * h;
        const double sx = (r1x + r2x) * h, sy = (r1y + r2y) * h, dx = (r1x - r2x) * h, dy = (r1y - r2y) * h;
        corner(s, X - sx, Y - sy, 0.25, ax, ay, node);
        corner(s, X + dx, Y + dy, 0.25, bx, by, node);
        corner(s, X + sx, Y + sy, 0.25, -ax, -ay, node);
        corner(s, X - dx, Y - dy, 0.25, -bx, -by, node);
    }
};

template <class Weights> static void step(const Body &s) {
    std::fill(s.mass, s.mass + s.nodes, 0.0);
    std::fill(s.given, s.given + 4 * s.nodes, 0.0);
    for (Index p = 0; p < s.count; ++p) {
        const Load l = load(s, p);
        Weights::each(s, p, [&](Index i, double N, double gx, double gy) { give(s, i, N, gx, gy, l); });
    }
    for (Index i = 0; i < s.nodes; ++i) {
        const double inverse = s.mass[i] > s.cutoff ? 1.0 / s.mass[i] : 0.0;
        for (int a = 0; a < 2; ++a) {
            const double force = s.given[4 * i + 2 + a];
            s.taken[4 * i + a] = s.held[2 * i + a] ? 0.0 : inverse * (s.given[4 * i + a] + s.dt * force);
            s.taken[4 * i + 2 + a] = s.held[2 * i + a] ? 0.0 : inverse * force;
        }
    }
    for (Index p = 0; p < s.count; ++p) {
        Sum sum{};
        Weights::each(s, p, [&](Index i, double N, double gx, double gy) { take(s, i, N, gx, gy, sum); });
        move(s, p, sum);
    }
}

extern "C" void mpm(const Body *s) { step<Hats>(*s); }
extern "C" void cpdi(const Body *s) { step<Parallelogram>(*s); }
