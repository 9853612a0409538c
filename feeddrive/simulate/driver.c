/* Runs a plant over samples with steps of its own choice. The functions feeddrive_* and the sizes stand above.
 *
 * A step that Newton does not solve, or whose error is above the tolerance, is taken again at half its length; where
 * the error is far below, the next one is twice as long. feeddrive/simulate/interpreted.py takes the same decisions
 * with the same numbers, for machines without a compiler: change both or neither.
 */

enum { DONE = 0, NEEDS_CONSTANTS = 1, NO_SOLUTION = 2, OFF_GRID = 3 };

#define BLANK 1 /* C has no arrays of length zero */
#define COARSER 0.02
#define SWEEPS 12

/* steps, refused, sweeps, steps over the tolerance, error of the worst, sum of theirs, finest level, largest sweep */
enum { STEPS, REFUSED, SWEPT, OVER, WORST, EXCESS, FINEST, LAST_SWEEP, REPORTS };

typedef const double *in;

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
  double base[N_BASE + BLANK], guess[N_UNKNOWN + BLANK], error = 0.0;
  {
    in arg[] = {memory, held, &place, &start, fixed};
    double *res[] = {base, guess};
    feeddrive_begin(arg, res, iw, w, 0);
  }
  double change = solve(memory, base, guess, &start, fixed, values, iw, w, report);
  if (!(change < 1.0)) return -1.0;
  if (change > report[LAST_SWEEP]) report[LAST_SWEEP] = change;
  in arg[] = {memory, held, &place, guess, fixed, &start, values};
  double *res[] = {after, &error};
  feeddrive_finish(arg, res, iw, w, 0);
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
