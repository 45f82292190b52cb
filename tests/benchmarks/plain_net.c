/* The free flight of a square net in plain C: the yardstick that the net capture FMU is timed against.

   One in-place sweep over the rows of knots a substep, in planes of one coordinate each. Of every thread along a row and
   to the next one the slack test is a loop without branches, which the compiler turns into vector instructions; square
   root, division and dashpot are for the taut ones. Then no later row needs this one as it was: it is kicked, if
   anything pulled, and drifted. Every row is tested and drifted in every substep.

   Leapfrog: velocities live half a substep back, dashpots see those predicted for the instant of the positions. */

#include <math.h>

typedef struct {
    int knots;              /* per side */
    int pitch;              /* of a row in doubles: the knots and some padding, a multiple of a vector */
    double length;          /* of a thread, unloaded [m] */
    double stiffness;       /* of a thread [N/m] */
    double damping;         /* its dashpot [N s/m] */
    double substep;         /* [s] */
    double *position[3];    /* planes of knots x pitch [m] */
    double *velocity[3];    /* half a substep back [m/s] */
    double *predicted[3];   /* for the instant of the positions [m/s] */
    double *inverse;        /* of each knot's mass [1/kg]; zero in the padding */
    double *peak[2];        /* largest tension of the thread along the row, and to the next row, from each knot [N] */
    double *scratch;        /* seven rows: forces on this row and the next [N], excess [m2] */
    int *kicked;            /* of each row: whether in the substep before; at first not */
} Net;

/* By how much each squared length between knots a + j and b + j exceeds the squared rest length; how many do. */
static int find_taut(const Net *net, int a, int b, int count, double *restrict excess)
{
    const double *x = net->position[0], *y = net->position[1], *z = net->position[2];
    const double squared = net->length * net->length;
    int taut = 0;
    for (int j = 0; j < count; j++) {
        double dx = x[b + j] - x[a + j], dy = y[b + j] - y[a + j], dz = z[b + j] - z[a + j];
        excess[j] = dx * dx + dy * dy + dz * dz - squared;
        taut += excess[j] > 0.0;
    }
    return taut;
}

/* Adds the forces of the taut threads between knots a + j and b + j to both ends, T = max(0, k (L - L0) + d dL/dt);
   whether there are any. */
static int pull(const Net *net, int a, int b, int count, double *on_a, double *on_b, double *peak)
{
    const int pitch = net->pitch;
    const double *x = net->position[0], *y = net->position[1], *z = net->position[2];
    const double *u = net->predicted[0], *v = net->predicted[1], *w = net->predicted[2];
    double *excess = net->scratch + 6 * pitch;
    int lanes[count], found = 0;
    if (!find_taut(net, a, b, count, excess))
        return 0;
    for (int j = 0; j < count; j++) {
        lanes[found] = j;
        found += excess[j] > 0.0;
    }
    for (int i = 0; i < found; i++) {
        int j = lanes[i], s = a + j, t = b + j;
        double dx = x[t] - x[s], dy = y[t] - y[s], dz = z[t] - z[s];
        double length = sqrt(dx * dx + dy * dy + dz * dz), inverse = 1.0 / length;
        double rate = ((u[t] - u[s]) * dx + (v[t] - v[s]) * dy + (w[t] - w[s]) * dz) * inverse;
        double tension = net->stiffness * (length - net->length) + net->damping * rate;
        tension = tension > 0.0 ? tension : 0.0;
        peak[j] = tension > peak[j] ? tension : peak[j];
        double share = tension * inverse;
        on_a[j] += share * dx;
        on_b[j] -= share * dx;
        on_a[pitch + j] += share * dy;
        on_b[pitch + j] -= share * dy;
        on_a[2 * pitch + j] += share * dz;
        on_b[2 * pitch + j] -= share * dz;
    }
    return 1;
}

/* One coordinate of a row half a substep on in velocity, and its forces cleared. */
static void kick(int count, double h, double *restrict velocity, double *restrict predicted, double *restrict force,
                 const double *restrict inverse)
{
    for (int j = 0; j < count; j++) {
        double change = h * (force[j] * inverse[j]);
        velocity[j] += change;
        predicted[j] = velocity[j] + 0.5 * change;
        force[j] = 0.0;
    }
}

/* One coordinate of a row a substep on in position. */
static void drift(int count, double h, double *restrict position, const double *restrict velocity)
{
    for (int j = 0; j < count; j++)
        position[j] += h * velocity[j];
}

/* So many substeps on. */
void fly(const Net *net, long steps)
{
    const int n = net->knots, pitch = net->pitch;
    const double h = net->substep;
    for (int j = 0; j < 6 * pitch; j++)
        net->scratch[j] = 0.0;
    for (long step = 0; step < steps; step++) {
        int pulled = 0;
        for (int row = 0; row < n; row++) {
            int at = row * pitch;
            double *here = net->scratch + row % 2 * 3 * pitch, *there = net->scratch + (1 - row % 2) * 3 * pitch;
            pulled |= pull(net, at, at + 1, n - 1, here, here + 1, net->peak[0] + at);
            int next = row < n - 1 ? pull(net, at, at + pitch, n, here, there, net->peak[1] + at) : 0;
            pulled |= next;
            for (int i = 0; i < 3; i++) {
                if (pulled || net->kicked[row]) /* once more without forces: then the prediction is the velocity */
                    kick(pitch, h, net->velocity[i] + at, net->predicted[i] + at, here + i * pitch, net->inverse + at);
                drift(pitch, h, net->position[i] + at, net->velocity[i] + at);
            }
            net->kicked[row] = pulled;
            pulled = next;
        }
    }
}
