/* The drive of _drive.py by Runge and Kutta's fourth-order method with fixed substeps, and its right-hand side. */
#include <math.h>

enum { COORDINATES = 5, STATES = 12, TORQUE = 10, BRISTLE = 11 };

typedef struct {
  double acceleration[COORDINATES][2 * COORDINATES]; /* of the coordinates, by coordinates and rates */
  double by_torque[COORDINATES], by_force[COORDINATES];
  double lag, stiffness, damping, coulomb, extra, stribeck, viscous;
} machine;

typedef struct {
  double position_gain, velocity_gain, integral_gain, limit, radius;
  long long divider;
} gains;

void drive_slopes(const machine *m, const double *y, double command, double *slope) {
  double v = y[9], share = v / m->stribeck;
  double level = m->coulomb + m->extra * exp(-share * share);
  double bristle = v - m->stiffness * fabs(v) / level * y[BRISTLE];
  double friction = m->stiffness * y[BRISTLE] + m->damping * bristle + m->viscous * v;
  for (int i = 0; i < COORDINATES; ++i) {
    double sum = m->by_torque[i] * y[TORQUE] - m->by_force[i] * friction;
    for (int k = 0; k < 2 * COORDINATES; ++k) sum += m->acceleration[i][k] * y[k];
    slope[i] = y[COORDINATES + i];
    slope[COORDINATES + i] = sum;
  }
  slope[TORQUE] = (command - y[TORQUE]) / m->lag;
  slope[BRISTLE] = bristle;
}

/* The same of several states that stand in columns, as solvers ask for a Jacobian. */
void drive_slopes_columns(const machine *m, long long columns, const double *y, double command, double *slope) {
  double one[STATES], rates[STATES];
  for (long long k = 0; k < columns; ++k) {
    for (int i = 0; i < STATES; ++i) one[i] = y[i * columns + k];
    drive_slopes(m, one, command, rates);
    for (int i = 0; i < STATES; ++i) slope[i * columns + k] = rates[i];
  }
}

void runge_kutta_run(long long samples, long long substeps, double sample, const machine *m, const gains *c,
                     const double *wanted, double *table) {
  double y[STATES] = {0}, at[STATES], k[4][STATES], integral = 0, speed_wanted = 0;
  const double h = sample / (double)substeps;
  for (long long n = 0; n < samples; ++n) {
    table[n] = y[4];
    if (n % c->divider == 0) speed_wanted = c->position_gain * (wanted[n] - y[4]);
    double error = speed_wanted / c->radius - y[5];
    double asked = c->velocity_gain * error + integral;
    double torque = asked > c->limit ? c->limit : asked < -c->limit ? -c->limit : asked;
    if (torque == asked) integral += c->integral_gain * error;
    for (long long sub = 0; sub < substeps; ++sub) {
      drive_slopes(m, y, torque, k[0]);
      for (int i = 0; i < STATES; ++i) at[i] = y[i] + 0.5 * h * k[0][i];
      drive_slopes(m, at, torque, k[1]);
      for (int i = 0; i < STATES; ++i) at[i] = y[i] + 0.5 * h * k[1][i];
      drive_slopes(m, at, torque, k[2]);
      for (int i = 0; i < STATES; ++i) at[i] = y[i] + h * k[2][i];
      drive_slopes(m, at, torque, k[3]);
      for (int i = 0; i < STATES; ++i) y[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
  }
}
