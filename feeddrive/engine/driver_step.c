/* One step of a plant. The functions feeddrive_* and the sizes stand above.
 *
 * step.py holds the same equations (begin, finish) for machines without a compiler: change both or neither.
 */
#include <math.h>

#define BLANK 1 /* C has no arrays of length zero */
#define SWEEPS 12

/* steps, refused, sweeps, steps over the tolerance, error of the worst, sum of theirs, finest level, largest sweep, sum
   of all that is seen: no number where any of it is none */
enum { STEPS, REFUSED, SWEPT, OVER, WORST, EXCESS, FINEST, LAST_SWEEP, SEEN, REPORTS };

typedef const double *in;

/* Where things are in the constants of a step, per node E, I, A, B: state = E state + I input + A f_1 + B f_2. */
enum {
  SQUARE = N_STATES * N_STATES,
  NODE = SQUARE + N_STATES * (N_HELD + 2 * N_FORCED),
  SPAN = 2 * NODE, /* step, its share of the part, reference */
  SCALES = SPAN + 3,
  ON_CURVATURE = SCALES + N_SOLVED,
  ON_CHANGE = ON_CURVATURE + N_WATCHED,
  /* and in the memory */
  BRISTLE = N_STATES,
  VALUE = BRISTLE + N_BRISTLES,
  CURVATURE = VALUE + N_WATCHED,
  SLOPE = CURVATURE + N_WATCHED
};

static const int read_rows[] = READ; /* rows of the states, then of the inputs, that the effects read */
static const double nodes[2] = {1.0 / 3.0, 1.0};

/* Value, rate, acceleration at a place in 0..1 of the cubic with (value, rate) at both ends, span [s] apart. */
static void cubic(in ends, double place, double span, double *motion) {
  double a = span * ends[1], b = span * ends[3], rise = ends[2] - ends[0];
  double c2 = 3 * rise - 2 * a - b, c3 = a + b - 2 * rise;
  motion[0] = ends[0] + place * (a + place * (c2 + place * c3));
  motion[1] = (a + place * (2 * c2 + place * 3 * c3)) / span;
  motion[2] = (2 * c2 + place * 6 * c3) / (span * span);
}

/* The input as a step sees it: of a cubic, the part from place on. */
static void step_input(in held, double place, in fixed, double *input) {
  for (int k = 0; k < N_HELD; ++k) input[k] = held[k];
#if DRIVEN
  double share = fixed[SPAN + 1], span = fixed[SPAN] / share;
  if (share != 1.0) {
    double begin[3], end[3];
    cubic(held, place, span, begin);
    cubic(held, place + share, span, end);
    input[0] = begin[0], input[1] = begin[1], input[2] = end[0], input[3] = end[1];
  }
#endif
}

/* What a step was solved with: the input, the states at its end and what the effects read without node forces. */
typedef struct {
  double input[N_HELD + BLANK], end[N_STATES + BLANK], base[N_BASE + BLANK], guess[N_UNKNOWN + BLANK];
} solved_step;

static double free_row(in memory, in input, in node, int row) {
  double by_state = 0.0, by_input = 0.0;
  for (int k = 0; k < N_STATES; ++k) by_state += node[row + N_STATES * k] * memory[k];
  for (int k = 0; k < N_HELD; ++k) by_input += node[SQUARE + row + N_STATES * k] * input[k];
  return by_state + by_input;
}

/* The states at the end of a step without node forces: column by column, as the compiler can take several at once. */
static void free_end(in memory, in input, in node, double *end) {
  double by_input[N_STATES + BLANK] = {0};
  for (int i = 0; i < N_STATES; ++i) end[i] = 0.0;
  for (int k = 0; k < N_STATES; ++k)
    for (int i = 0; i < N_STATES; ++i) end[i] += node[i + N_STATES * k] * memory[k];
  for (int k = 0; k < N_HELD; ++k)
    for (int i = 0; i < N_STATES; ++i) by_input[i] += node[SQUARE + i + N_STATES * k] * input[k];
  for (int i = 0; i < N_STATES; ++i) end[i] += by_input[i];
}

static void begin(in memory, in held, double place, in fixed, solved_step *step) {
  double h = fixed[SPAN], given[2][N_HELD < 3 ? 3 : N_HELD] = {{0}}; /* held inputs, or the motion of a driven motor */
  double *base = step->base, *guess = step->guess;
  (void)held, (void)place;
#if READS_INPUT
  for (int n = 0; n < 2; ++n) {
#if DRIVEN
    double share = fixed[SPAN + 1];
    cubic(held, place + nodes[n] * share, h / share, given[n]);
#else
    for (int k = 0; k < N_HELD; ++k) given[n][k] = step->input[k];
#endif
  }
#endif
  free_end(memory, step->input, fixed + NODE, step->end);
  for (int k = 0; k < N_READ; ++k) {
    int row = read_rows[k], held_row = row - N_STATES;
    base[k] = row < N_STATES ? free_row(memory, step->input, fixed, row) : given[0][held_row];
    base[N_READ + k] = row < N_STATES ? step->end[row] : given[1][held_row];
  }
  for (int n = 0; n < 2; ++n) {
    double time = nodes[n] * h;
    for (int k = 0; k < N_FORCED; ++k) /* the parabola of the last step */
      guess[n * N_FORCED + k] = memory[VALUE + k] + time * (memory[SLOPE + k] + 3 * time * memory[CURVATURE + k]);
    for (int k = 0; k < N_BRISTLES; ++k) guess[2 * N_FORCED + n * N_BRISTLES + k] = memory[BRISTLE + k];
  }
}

/* The memory after a step, and the error over the tolerance. */
static double finish(in memory, in fixed, const solved_step *step, double *after) {
  in on_force = fixed + NODE + SQUARE + N_STATES * N_HELD, guess = step->guess;
  double h = fixed[SPAN], error = 0.0, by_force[N_STATES + BLANK] = {0};
  for (int k = 0; k < 2 * N_FORCED; ++k)
    for (int i = 0; i < N_STATES; ++i) by_force[i] += on_force[i + N_STATES * k] * guess[k];
  for (int i = 0; i < N_STATES; ++i) after[i] = step->end[i] + by_force[i];
  for (int k = 0; k < N_BRISTLES; ++k) after[BRISTLE + k] = guess[2 * N_FORCED + N_BRISTLES + k];
  for (int k = 0; k < N_WATCHED; ++k) {
    double first, second;
    if (N_FORCED) {
      first = guess[k];
      second = guess[N_FORCED + k];
    } else { /* rates of the bristles, from what Radau made of them */
      double one = guess[k] - memory[BRISTLE + k], two = guess[N_BRISTLES + k] - memory[BRISTLE + k];
      first = (1.5 * one + 0.5 * two) / h;
      second = (2.5 * two - 4.5 * one) / h;
    }
    double missed = memory[VALUE + k] - 1.5 * first + 0.5 * second;
    error += fixed[ON_CURVATURE + k] * fabs(missed);
    error += fixed[ON_CHANGE + k] * fabs(missed - memory[CURVATURE + k] * (h * h));
    after[VALUE + k] = second;
    after[CURVATURE + k] = missed / (h * h);
    after[SLOPE + k] = (1.5 * (second - first) + 2 * missed) / h;
  }
  return error;
}

static double solve(in memory, in base, double *guess, in time, in fixed, in values, long long *iw, double *w,
                    double *report) {
  double other[N_UNKNOWN + BLANK], change = 0.0, before = 1e300;
  for (int sweep = 0; sweep < SWEEPS; ++sweep) {
    const double *from = sweep & 1 ? other : guess;
    double *to = sweep & 1 ? guess : other;
    in arg[] = {memory, base, from, time, fixed, values};
    double *res[] = {to, &change};
    feeddrive_iterate(arg, res, iw, w, 0);
    report[SWEPT] += 1;
    if (change < 1.0 || !(change < 1e290) || (sweep > 3 && change > before)) {
      if (!(sweep & 1)) for (int k = 0; k < N_UNKNOWN; ++k) guess[k] = other[k];
      break;
    }
    before = change;
  }
  return change;
}

/* One step from memory to after; its error over the tolerance, or a negative number where Newton found nothing. */
static double attempt(in memory, in held, double place, double start, in fixed, in values, double *after,
                      solved_step *step, long long *iw, double *w, double *report) {
  step_input(held, place, fixed, step->input);
  begin(memory, held, place, fixed, step);
  double change = N_UNKNOWN ? solve(memory, step->base, step->guess, &start, fixed, values, iw, w, report) : 0.0;
  if (!(change < 1.0)) return -1.0;
  if (change > report[LAST_SWEEP]) report[LAST_SWEEP] = change;
  double error = finish(memory, fixed, step, after);
  return error < 1e290 ? error : -1.0;
}

