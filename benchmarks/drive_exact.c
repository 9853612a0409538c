/* The drive of _drive.py by hand: the scheme of feeddrive's engine, written for this one machine.
 *
 * Exact propagation of 10 mechanical states and the torque loop, the force of the table's bristle friction on two Radau
 * nodes, the deflection solved linearly given the velocities, sweeps until the force moves by less than 1e-9, the error
 * of the step estimated as the engine does. It shares no code with the package.
 */
#include <math.h>

enum { STATES = 11, TABLE_V = 9, TABLE_X = 4, MOTOR_V = 5 };

typedef struct { /* how the state at a node follows: from the state, the command, the two node forces */
  double state[STATES][STATES], command[STATES], first[STATES], second[STATES];
} node_map;

typedef struct {
  node_map node[2];
  double step, stiffness, damping, coulomb, extra, stribeck, viscous, full_scale, on_curvature, on_change;
  double peak, centre, half_width; /* of the bump in the Coulomb level, with -DBUMP */
} machine;

typedef struct {
  double position_gain, velocity_gain, integral_gain, limit, radius;
  long long divider;
} gains;

static double level(const machine *m, double v, double x) {
  double share = v / m->stribeck, sum = m->coulomb + m->extra * exp(-share * share);
#ifdef BUMP
  double aside = (x - m->centre) / m->half_width;
  sum += m->peak * exp(-aside * aside);
#endif
  return sum;
}

/* command, then the states at every sample in `shown`; returns how many steps have an error above the tolerance */
long long exact_run(long long samples, const machine *m, const gains *c, const double *wanted, double *shown) {
  double s[STATES] = {0}, next[STATES], z = 0, integral = 0, speed_wanted = 0;
  double f0 = 0, curvature = 0, slope = 0;
  const double h = m->step;
  const double *row = m->node[0].state[TABLE_V], *end = m->node[1].state[TABLE_V];
  long long over = 0;
  for (long long k = 0; k < samples; ++k) {
    if (k % c->divider == 0) speed_wanted = c->position_gain * (wanted[k] - s[TABLE_X]);
    double error = speed_wanted / c->radius - s[MOTOR_V];
    double asked = c->velocity_gain * error + integral;
    double torque = asked > c->limit ? c->limit : asked < -c->limit ? -c->limit : asked;
    if (torque == asked) integral += c->integral_gain * error;
    double *out = shown + k * (STATES + 1);
    out[0] = torque;
    for (int i = 0; i < STATES; ++i) out[1 + i] = s[i];

    double free1 = m->node[0].command[TABLE_V] * torque, free2 = m->node[1].command[TABLE_V] * torque;
    for (int i = 0; i < STATES; ++i) {
      free1 += row[i] * s[i];
      free2 += end[i] * s[i];
    }
    double place1 = 0, place2 = 0;
#ifdef BUMP
    place1 = m->node[0].command[TABLE_X] * torque, place2 = m->node[1].command[TABLE_X] * torque;
    for (int i = 0; i < STATES; ++i) {
      place1 += m->node[0].state[TABLE_X][i] * s[i];
      place2 += m->node[1].state[TABLE_X][i] * s[i];
    }
#endif
    double f1 = f0 + h / 3 * (slope + h * curvature), f2 = f0 + h * (slope + 3 * h * curvature);
    double z1 = z, z2 = z;
    for (int sweep = 0; sweep < 20; ++sweep) {
      double v1 = free1 + m->node[0].first[TABLE_V] * f1 + m->node[0].second[TABLE_V] * f2;
      double v2 = free2 + m->node[1].first[TABLE_V] * f1 + m->node[1].second[TABLE_V] * f2;
      double x1 = place1, x2 = place2;
#ifdef BUMP
      x1 += m->node[0].first[TABLE_X] * f1 + m->node[0].second[TABLE_X] * f2;
      x2 += m->node[1].first[TABLE_X] * f1 + m->node[1].second[TABLE_X] * f2;
#endif
      double a1 = m->stiffness * fabs(v1) / level(m, v1, x1), a2 = m->stiffness * fabs(v2) / level(m, v2, x2);
      /* z_i = z + h sum a_ij (v_j - a_j z_j), two equations */
      double m11 = 1 + h * 5 / 12 * a1, m12 = -h / 12 * a2, m21 = h * 3 / 4 * a1, m22 = 1 + h / 4 * a2;
      double r1 = z + h * (5.0 / 12 * v1 - 1.0 / 12 * v2), r2 = z + h * (0.75 * v1 + 0.25 * v2);
      double det = m11 * m22 - m12 * m21;
      z1 = (r1 * m22 - m12 * r2) / det;
      z2 = (m11 * r2 - m21 * r1) / det;
      double g1 = -(m->stiffness * z1 + m->damping * (v1 - a1 * z1) + m->viscous * v1);
      double g2 = -(m->stiffness * z2 + m->damping * (v2 - a2 * z2) + m->viscous * v2);
      double change = fmax(fabs(g1 - f1), fabs(g2 - f2));
      f1 = g1;
      f2 = g2;
      if (change < fmax(1e-9 * fmax(fabs(f1), fabs(f2)), m->full_scale)) break;
    }
    const node_map *n = &m->node[1];
    for (int r = 0; r < STATES; ++r) {
      double sum = n->command[r] * torque + n->first[r] * f1 + n->second[r] * f2;
      for (int i = 0; i < STATES; ++i) sum += n->state[r][i] * s[i];
      next[r] = sum;
    }
    for (int r = 0; r < STATES; ++r) s[r] = next[r];
    double missed = f0 - 1.5 * f1 + 0.5 * f2;
    if (m->on_curvature * fabs(missed) + m->on_change * fabs(missed - curvature * h * h) > 1) ++over;
    curvature = missed / (h * h);
    slope = (1.5 * (f2 - f1) + 2 * missed) / h;
    z = z2;
    f0 = f2;
  }
  return over;
}
