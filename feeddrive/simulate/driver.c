/* Runs a plant over samples with steps of its own choice. The functions feeddrive_* and the sizes stand above.
 *
 * A step that Newton does not solve, or whose error is above the tolerance, is taken again at half its length; where
 * the error is far below, the next one is twice as long. feeddrive/simulate/interpreted.py takes the same decisions,
 * and step.py holds the same equations (begin, finish) for machines without a compiler: change both or neither.
 */
#include <math.h>

enum { DONE = 0, NEEDS_CONSTANTS = 1, NO_SOLUTION = 2, OFF_GRID = 3 };

#define BLANK 1 /* C has no arrays of length zero */
#define COARSER 0.02
#define SWEEPS 12

/* steps, refused, sweeps, steps over the tolerance, error of the worst, sum of theirs, finest level, largest sweep */
enum { STEPS, REFUSED, SWEPT, OVER, WORST, EXCESS, FINEST, LAST_SWEEP, REPORTS };

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

static const int needed_first[] = NEEDED_FIRST, needed_second[] = NEEDED_SECOND;
static const double nodes[2] = {1.0 / 3.0, 1.0};

/* Value and rate at a place in 0..1 of the cubic with (value, rate) at both ends, span [s] apart. */
static void cubic(in ends, double place, double span, double *value, double *rate) {
  double a = span * ends[1], b = span * ends[3], rise = ends[2] - ends[0];
  double c2 = 3 * rise - 2 * a - b, c3 = a + b - 2 * rise;
  *value = ends[0] + place * (a + place * (c2 + place * c3));
  *rate = (a + place * (2 * c2 + place * 3 * c3)) / span;
}

/* The input as a step sees it: of a cubic, the part from place on. */
static void step_input(in held, double place, in fixed, double *input) {
  for (int k = 0; k < N_HELD; ++k) input[k] = held[k];
#if DRIVEN
  double share = fixed[SPAN + 1], span = fixed[SPAN] / share;
  if (share != 1.0) {
    cubic(held, place, span, input, input + 1);
    cubic(held, place + share, span, input + 2, input + 3);
  }
#endif
}

static double free_row(in memory, in input, in node, int row) {
  double by_state = 0.0, by_input = 0.0;
  for (int k = 0; k < N_STATES; ++k) by_state += node[row + N_STATES * k] * memory[k];
  for (int k = 0; k < N_HELD; ++k) by_input += node[SQUARE + row + N_STATES * k] * input[k];
  return by_state + by_input;
}

static void begin(in memory, in held, in input, double place, in fixed, double *base, double *guess) {
  double motor[4] = {0, 0, 0, 0}, h = fixed[SPAN];
#if DRIVEN
  double share = fixed[SPAN + 1];
  for (int n = 0; n < 2; ++n) cubic(held, place + nodes[n] * share, h / share, motor + 2 * n, motor + 2 * n + 1);
#endif
  for (int k = 0; k < N_NEEDED_FIRST; ++k) {
    int row = needed_first[k];
    base[k] = row < N_STATES ? free_row(memory, input, fixed, row) : motor[row - N_STATES];
  }
  for (int k = 0; k < N_NEEDED_SECOND; ++k) {
    int row = needed_second[k];
    base[N_NEEDED_FIRST + k] = row < N_STATES ? free_row(memory, input, fixed + NODE, row) : motor[2 + row - N_STATES];
  }
  for (int n = 0; n < 2; ++n) {
    double time = nodes[n] * h;
    for (int k = 0; k < N_FORCED; ++k) /* the parabola of the last step */
      guess[n * N_FORCED + k] = memory[VALUE + k] + time * (memory[SLOPE + k] + 3 * time * memory[CURVATURE + k]);
    for (int k = 0; k < N_BRISTLES; ++k) guess[2 * N_FORCED + n * N_BRISTLES + k] = memory[BRISTLE + k];
  }
}

/* The memory after a step, and the error over the tolerance. */
static double finish(in memory, in input, in fixed, in guess, double *after) {
  in node = fixed + NODE, on_input = node + SQUARE, on_force = on_input + N_STATES * N_HELD;
  double h = fixed[SPAN], error = 0.0;
  double by_input[N_STATES + BLANK] = {0}, by_force[N_STATES + BLANK] = {0};
  for (int i = 0; i < N_STATES; ++i) after[i] = 0.0;
  for (int k = 0; k < N_STATES; ++k)
    for (int i = 0; i < N_STATES; ++i) after[i] += node[i + N_STATES * k] * memory[k];
  for (int k = 0; k < N_HELD; ++k)
    for (int i = 0; i < N_STATES; ++i) by_input[i] += on_input[i + N_STATES * k] * input[k];
  for (int k = 0; k < 2 * N_FORCED; ++k)
    for (int i = 0; i < N_STATES; ++i) by_force[i] += on_force[i + N_STATES * k] * guess[k];
  for (int i = 0; i < N_STATES; ++i) after[i] = after[i] + by_input[i] + by_force[i];
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
                      long long *iw, double *w, double *report) {
  double input[N_HELD + BLANK], base[N_BASE + BLANK], guess[N_UNKNOWN + BLANK];
  step_input(held, place, fixed, input);
  begin(memory, held, input, place, fixed, base, guess);
  double change = N_UNKNOWN ? solve(memory, base, guess, &start, fixed, values, iw, w, report) : 0.0;
  if (!(change < 1.0)) return -1.0;
  if (change > report[LAST_SWEEP]) report[LAST_SWEEP] = change;
  double error = finish(memory, input, fixed, guess, after);
  return error < 1e290 ? error : -1.0;
}

/* Where the machine is between steps, but for its memory. */
typedef struct {
  long long sample, level, cell, needed_cell, needed_level;
} place_of_run;

/* Constants per part, cell and level; those that are not made are asked for. Cells are `width` of table position. */
typedef struct {
  const double *fixed;
  const unsigned char *made;
  long long first_cell, cells;
  double width;
} constants_of_run;

/* The watched forces are those beyond the chain at the reference of a cell: in another cell they are others. */
static void watch(double *memory, in held, double place, double start, in fixed, in values, long long *iw, double *w) {
  double after[N_MEMORY + BLANK];
  in arg[] = {memory, held, &place, &start, fixed, values};
  double *res[] = {after};
  feeddrive_watch(arg, res, iw, w, 0);
  for (int k = 0; k < N_MEMORY; ++k) memory[k] = after[k];
}

/* One part of a sample, in steps; the level of the last one is kept for the next part. */
static int advance(double *memory, in held, double start, double span, int part, const constants_of_run *table,
                   in values, place_of_run *run, long long *iw, double *w, double *report) {
  const long long whole = 1LL << DEEPEST;
  long long at = 0;
  double after[N_MEMORY + BLANK];
  while (at < whole) {
    long long length = whole >> run->level;
    double place = (double)at / (double)whole, now = start + place * span;
    long long cell = VARIES ? (long long)floor(memory[TABLE] / table->width + 0.5) - table->first_cell : 0;
    if (cell < 0 || cell >= table->cells) return OFF_GRID;
    run->needed_cell = cell;
    if (!table->made[cell * (DEEPEST + 1) + run->level]) return NEEDS_CONSTANTS;
    in fixed = table->fixed + ((part * table->cells + cell) * (DEEPEST + 1) + run->level) * N_FIXED;
    if (run->cell != cell + table->first_cell) {
      watch(memory, held, place, now, fixed, values, iw, w);
      run->cell = cell + table->first_cell;
    }
    double error = attempt(memory, held, place, now, fixed, values, after, iw, w, report);
    if (!(error >= 0.0 && error <= 1.0) && run->level < DEEPEST) {
      run->level += 1;
      report[REFUSED] += 1;
      continue;
    }
    if (error < 0.0) return NO_SOLUTION;
    if (error > 1.0) {
      report[OVER] += 1;
      report[EXCESS] += error;
    }
    if (error > report[WORST]) report[WORST] = error;
    if ((double)run->level > report[FINEST]) report[FINEST] = (double)run->level;
    report[STEPS] += 1;
    for (int k = 0; k < N_MEMORY; ++k) memory[k] = after[k];
    at += length;
    if (run->level > 0 && error < COARSER && at % (2 * length) == 0) run->level -= 1;
  }
  return DONE;
}

/* Samples from run->sample on; on return run says where it ended, and memory and own are those at its start. */
int feeddrive_run(long long samples, place_of_run *run, double *memory, double *own, in fed, in spans,
                  const constants_of_run *table, in settings, in values, double *seen, double *report, long long *iw,
                  double *w) {
  double kept[N_MEMORY + BLANK], next[N_OWN + BLANK], held[N_PARTS * N_HELD + BLANK];
  for (; run->sample < samples; ++run->sample) {
    in row = fed + run->sample * N_FED;
    double *shown = seen + run->sample * (N_BEFORE + N_AFTER);
    double start = row[N_FED - 1];
    long long level_before = run->level, cell_before = run->cell;
    for (int k = 0; k < N_MEMORY; ++k) kept[k] = memory[k];
    {
      in arg[] = {memory, own, row, settings, values};
      double *res[] = {next, held, shown};
      feeddrive_before(arg, res, iw, w, 0);
    }
    for (int part = 0; part < N_PARTS; ++part) {
      int status = advance(memory, held + part * N_HELD, start, spans[part], part, table, values, run, iw, w, report);
      if (status != DONE) {
        for (int k = 0; k < N_MEMORY; ++k) memory[k] = kept[k];
        run->needed_level = run->level;
        run->level = level_before;
        run->cell = cell_before;
        return status;
      }
      start += spans[part];
    }
    for (int k = 0; k < N_OWN; ++k) own[k] = next[k];
    if (N_AFTER) {
      in arg[] = {memory, own, row, settings, values};
      double *res[] = {shown + N_BEFORE};
      feeddrive_after(arg, res, iw, w, 0);
    }
  }
  return DONE;
}
