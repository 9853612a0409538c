/* Runs a plant over samples with steps of its own choice. driver_step.c and driver_tangents.c stand above.
 *
 * A step that Newton does not solve, or whose error is above the tolerance, is taken again at half its length; where
 * the error is far below, the next one is twice as long. feeddrive/engine/interpreted.py takes the same decisions.
 */
enum { DONE = 0, NEEDS_CONSTANTS = 1, NO_SOLUTION = 2, OFF_GRID = 3 };

#define COARSER 0.02

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

/* Room for the memory: at the start of the sample, which is kept for another try, now, and behind the next step. */
typedef struct {
  double *start, *now, *next, *spare;
} memories_of_run;

static void go_on(memories_of_run *m) {
  double *left = m->now == m->start ? m->spare : m->now;
  m->now = m->next;
  m->next = left;
}

/* The watched forces are those beyond the chain at the reference of a cell: in another cell they are others. */
static void watch(memories_of_run *m, in held, double place, double start, in fixed, in values, long long *iw,
                  double *w) {
  in arg[] = {m->now, held, &place, &start, fixed, values};
  double *res[] = {m->next};
  feeddrive_watch(arg, res, iw, w, 0);
  go_on(m);
}

/* One part of a sample, in steps; the level of the last one is kept for the next part. */
static int advance(memories_of_run *m, in held, double start, double span, int part, const constants_of_run *table,
                   in values, in held_changes, const tangents_of_run *tangents, place_of_run *run, long long *iw,
                   double *w, double *report) {
  const long long whole = 1LL << DEEPEST;
  long long at = 0;
  solved_step step;
  while (at < whole) {
    long long length = whole >> run->level;
    double place = (double)at / (double)whole, now = start + place * span;
    long long cell = VARIES ? (long long)floor(m->now[TABLE] / table->width + 0.5) - table->first_cell : 0;
    if (cell < 0 || cell >= table->cells) return OFF_GRID;
    run->needed_cell = cell;
    if (!table->made[cell * (DEEPEST + 1) + run->level]) return NEEDS_CONSTANTS;
    long long offset = ((part * table->cells + cell) * (DEEPEST + 1) + run->level) * N_FIXED;
    in fixed = table->fixed + offset;
    if (run->cell != cell + table->first_cell) {
      watch(m, held, place, now, fixed, values, iw, w);
      run->cell = cell + table->first_cell;
    }
    double error = attempt(m->now, held, place, now, fixed, values, m->next, &step, iw, w, report);
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
    move_tangents(m->now, &step, now, fixed, offset, values, held_changes, tangents, iw, w);
    go_on(m);
    at += length;
    if (run->level > 0 && error < COARSER && at % (2 * length) == 0) run->level -= 1;
  }
  return DONE;
}

/* Samples from run->sample on; on return run says where it ended, and memory and own are those at its start. */
int feeddrive_run(long long samples, place_of_run *run, double *memory, double *own, in fed, in spans,
                  const constants_of_run *table, in settings, in values, const tangents_of_run *tangents, double *seen,
                  double *report, double *room, long long *iw, double *w) {
  double next[N_OWN + BLANK], held[N_PARTS * N_HELD + BLANK], rooms[3][N_MEMORY + BLANK];
  double sums[N_BEFORE + N_AFTER + BLANK] = {0}, reported[REPORTS];
  memories_of_run m = {rooms[0], rooms[0], rooms[1], rooms[2]};
  int status = DONE;
  for (int k = 0; k < N_MEMORY; ++k) m.start[k] = memory[k];
  for (; run->sample < samples; ++run->sample) {
    in row = fed + run->sample * N_FED;
    double *shown = seen + run->sample * (N_BEFORE + N_AFTER), start = row[N_FED - 1];
    long long level_before = run->level, cell_before = run->cell;
    for (int k = 0; k < REPORTS; ++k) reported[k] = report[k];
    {
      in arg[] = {m.now, own, row, settings, values};
      double *res[] = {next, held, shown};
      feeddrive_before(arg, res, iw, w, 0);
    }
    begin_tangents(tangents, m.now, own, row, settings, values, samples, run->sample, room, iw, w);
    for (int part = 0; part < N_PARTS && status == DONE; ++part) {
      status = advance(&m, held + part * N_HELD, start, spans[part], part, table, values, room + part * N_HELD,
                       tangents, run, iw, w, report);
      start += spans[part];
    }
    if (status != DONE) {
      restore_tangents(tangents, room);
      for (int k = 0; k < REPORTS; ++k) report[k] = reported[k];
      run->needed_level = run->level;
      run->level = level_before;
      run->cell = cell_before;
      break;
    }
    m.spare = m.start;
    m.start = m.now;
    for (int k = 0; k < N_OWN; ++k) own[k] = next[k];
    finish_tangents(tangents, room);
    if (N_AFTER) {
      in arg[] = {m.now, own, row, settings, values};
      double *res[] = {shown + N_BEFORE};
      feeddrive_after(arg, res, iw, w, 0);
    }
    for (int k = 0; k < N_BEFORE + N_AFTER; ++k) sums[k] += shown[k];
  }
  for (int k = 0; k < N_BEFORE + N_AFTER; ++k) report[SEEN] += sums[k];
  for (int k = 0; k < N_MEMORY; ++k) memory[k] = m.start[k];
  return status;
}
