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

static double free_row(in memory, in input, in node, int row) {
  double by_state = 0.0, by_input = 0.0;
  for (int k = 0; k < N_STATES; ++k) by_state += node[row + N_STATES * k] * memory[k];
  for (int k = 0; k < N_HELD; ++k) by_input += node[SQUARE + row + N_STATES * k] * input[k];
  return by_state + by_input;
}

static void begin(in memory, in held, in input, double place, in fixed, double *base, double *guess) {
  (void)held, (void)place;
  double h = fixed[SPAN], given[2][N_HELD < 3 ? 3 : N_HELD]; /* held inputs, or the motion of a driven motor */
  for (int n = 0; n < 2; ++n) {
#if DRIVEN
    double share = fixed[SPAN + 1];
    cubic(held, place + nodes[n] * share, h / share, given[n]);
#else
    for (int k = 0; k < N_HELD; ++k) given[n][k] = input[k];
#endif
  }
  for (int k = 0; k < N_NEEDED_FIRST; ++k) {
    int row = needed_first[k];
    base[k] = row < N_STATES ? free_row(memory, input, fixed, row) : given[0][row - N_STATES];
  }
  for (int k = 0; k < N_NEEDED_SECOND; ++k) {
    int row = needed_second[k];
    base[N_NEEDED_FIRST + k] = row < N_STATES ? free_row(memory, input, fixed + NODE, row) : given[1][row - N_STATES];
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

/* How the run changes with parameters, per direction; `stride` between the constants of two directions. */
typedef struct {
  long long directions, stride;
  double *memory, *own, *seen;
  const double *settings, *values, *fixed;
  const unsigned char *on_fixed;
} tangents_of_run;

/* What a step was solved with. */
typedef struct {
  double input[N_HELD + BLANK], base[N_BASE + BLANK], guess[N_UNKNOWN + BLANK];
} solved_step;

#if TANGENTS
/* The states of all directions over one accepted step; `fixed` and `offset` say where the constants are. */
static void move_tangents(in memory, const solved_step *step, double start, in fixed, long long offset, in values,
                          in held_changes, const tangents_of_run *t, long long *iw, double *w) {
  static const double nothing[N_FIXED];
  for (long long d = 0; d < t->directions; ++d) {
    double *mine = t->memory + d * (N_STATES + N_BRISTLES), change[N_MEMORY + BLANK] = {0}, base[N_BASE + BLANK];
    double guess[N_UNKNOWN + BLANK], input[N_HELD];
    in other = t->on_fixed[d] ? t->fixed + d * t->stride + offset : nothing;
    for (int k = 0; k < N_STATES + N_BRISTLES; ++k) change[k] = mine[k];
    for (int k = 0; k < N_HELD; ++k) input[k] = held_changes[d * N_PARTS * N_HELD + k];
    for (int n = 0; n < 2; ++n) {
      const int *rows = n ? needed_second : needed_first, count = n ? N_NEEDED_SECOND : N_NEEDED_FIRST;
      for (int k = 0; k < count; ++k) {
        if (rows[k] >= N_STATES) {
          base[n * N_NEEDED_FIRST + k] = input[rows[k] - N_STATES];
          continue;
        }
        double sum = free_row(change, input, fixed + n * NODE, rows[k]);
        if (t->on_fixed[d]) sum += free_row(memory, step->input, other + n * NODE, rows[k]);
        base[n * N_NEEDED_FIRST + k] = sum;
      }
    }
    {
      in arg[] = {memory, step->base, step->guess, &start, fixed, values, change, base, other, t->values + d * N_VALUES};
      double *res[] = {guess};
      if (N_UNKNOWN) feeddrive_tangent(arg, res, iw, w, 0);
    }
    in node = fixed + NODE, moved = other + NODE;
    for (int i = 0; i < N_STATES; ++i) {
      double sum = free_row(change, input, node, i);
      for (int k = 0; k < 2 * N_FORCED; ++k)
        sum += node[SQUARE + N_STATES * (N_HELD + k) + i] * guess[k];
      if (t->on_fixed[d]) {
        sum += free_row(memory, step->input, moved, i);
        for (int k = 0; k < 2 * N_FORCED; ++k)
          sum += moved[SQUARE + N_STATES * (N_HELD + k) + i] * step->guess[k];
      }
      mine[i] = sum;
    }
    for (int k = 0; k < N_BRISTLES; ++k) mine[BRISTLE + k] = guess[2 * N_FORCED + N_BRISTLES + k];
  }
}
#endif

/* One step from memory to after; its error over the tolerance, or a negative number where Newton found nothing. */
static double attempt(in memory, in held, double place, double start, in fixed, in values, double *after,
                      solved_step *step, long long *iw, double *w, double *report) {
  step_input(held, place, fixed, step->input);
  begin(memory, held, step->input, place, fixed, step->base, step->guess);
  double change = N_UNKNOWN ? solve(memory, step->base, step->guess, &start, fixed, values, iw, w, report) : 0.0;
  if (!(change < 1.0)) return -1.0;
  if (change > report[LAST_SWEEP]) report[LAST_SWEEP] = change;
  double error = finish(memory, step->input, fixed, step->guess, after);
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
                   in values, in held_changes, const tangents_of_run *tangents, place_of_run *run, long long *iw,
                   double *w, double *report) {
  const long long whole = 1LL << DEEPEST;
  long long at = 0;
  double after[N_MEMORY + BLANK];
  solved_step step;
  while (at < whole) {
    long long length = whole >> run->level;
    double place = (double)at / (double)whole, now = start + place * span;
    long long cell = VARIES ? (long long)floor(memory[TABLE] / table->width + 0.5) - table->first_cell : 0;
    if (cell < 0 || cell >= table->cells) return OFF_GRID;
    run->needed_cell = cell;
    if (!table->made[cell * (DEEPEST + 1) + run->level]) return NEEDS_CONSTANTS;
    long long offset = ((part * table->cells + cell) * (DEEPEST + 1) + run->level) * N_FIXED;
    in fixed = table->fixed + offset;
    if (run->cell != cell + table->first_cell) {
      watch(memory, held, place, now, fixed, values, iw, w);
      run->cell = cell + table->first_cell;
    }
    double error = attempt(memory, held, place, now, fixed, values, after, &step, iw, w, report);
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
#if TANGENTS
    move_tangents(memory, &step, now, fixed, offset, values, held_changes, tangents, iw, w);
#else
    (void)held_changes, (void)tangents, (void)offset;
#endif
    for (int k = 0; k < N_MEMORY; ++k) memory[k] = after[k];
    at += length;
    if (run->level > 0 && error < COARSER && at % (2 * length) == 0) run->level -= 1;
  }
  return DONE;
}

/* Samples from run->sample on; on return run says where it ended, and memory and own are those at its start. */
int feeddrive_run(long long samples, place_of_run *run, double *memory, double *own, in fed, in spans,
                  const constants_of_run *table, in settings, in values, const tangents_of_run *tangents, double *seen,
                  double *report, double *room, long long *iw, double *w) {
#if TANGENTS
  /* room: changes of the held inputs, of the commands' memory, and the states kept for another try */
  const long long directions = tangents->directions, carried = N_STATES + N_BRISTLES;
  double *held_changes = room, *own_changes = held_changes + directions * N_PARTS * N_HELD,
         *kept_changes = own_changes + directions * N_OWN;
#else
  double *held_changes = room;
#endif
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
#if TANGENTS
    for (long long k = 0; k < directions * carried; ++k) kept_changes[k] = tangents->memory[k];
    for (long long d = 0; d < directions; ++d) {
      double change[N_MEMORY + BLANK] = {0};
      for (int k = 0; k < carried; ++k) change[k] = tangents->memory[d * carried + k];
      in arg[] = {memory, own, row, settings, values, change, tangents->own + d * N_OWN,
                  tangents->settings + d * N_SETTINGS, tangents->values + d * N_VALUES};
      double *res[] = {own_changes + d * N_OWN, held_changes + d * N_PARTS * N_HELD,
                       tangents->seen + (d * samples + run->sample) * N_BEFORE};
      feeddrive_before_tangent(arg, res, iw, w, 0);
    }
#endif
    for (int part = 0; part < N_PARTS; ++part) {
      int status = advance(memory, held + part * N_HELD, start, spans[part], part, table, values,
                           held_changes + part * N_HELD, tangents, run, iw, w, report);
      if (status != DONE) {
#if TANGENTS
        for (long long k = 0; k < directions * carried; ++k) tangents->memory[k] = kept_changes[k];
#endif
        for (int k = 0; k < N_MEMORY; ++k) memory[k] = kept[k];
        run->needed_level = run->level;
        run->level = level_before;
        run->cell = cell_before;
        return status;
      }
      start += spans[part];
    }
    for (int k = 0; k < N_OWN; ++k) own[k] = next[k];
#if TANGENTS
    for (long long k = 0; k < directions * N_OWN; ++k) tangents->own[k] = own_changes[k];
#endif
    if (N_AFTER) {
      in arg[] = {memory, own, row, settings, values};
      double *res[] = {shown + N_BEFORE};
      feeddrive_after(arg, res, iw, w, 0);
    }
  }
  return DONE;
}
