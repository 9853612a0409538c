/* How the run changes with parameters, per direction; `stride` between the constants of two directions. */
typedef struct {
  long long directions, stride;
  double *memory, *own, *seen;
  const double *settings, *values, *fixed;
  const unsigned char *on_fixed;
} tangents_of_run;

#if TANGENTS
enum { CARRIED = N_STATES + N_BRISTLES };

/* The states of all directions over one accepted step; `fixed` and `offset` say where the constants are. */
static void move_tangents(in memory, const solved_step *step, double start, in fixed, long long offset, in values,
                          in held_changes, const tangents_of_run *t, long long *iw, double *w) {
  static const double nothing[N_FIXED];
  for (long long d = 0; d < t->directions; ++d) {
    double *mine = t->memory + d * CARRIED, change[N_MEMORY + BLANK] = {0}, base[N_BASE + BLANK];
    double guess[N_UNKNOWN + BLANK], input[N_HELD];
    in other = t->on_fixed[d] ? t->fixed + d * t->stride + offset : nothing;
    for (int k = 0; k < CARRIED; ++k) change[k] = mine[k];
    for (int k = 0; k < N_HELD; ++k) input[k] = held_changes[d * N_PARTS * N_HELD + k];
    for (int n = 0; n < 2; ++n) {
      for (int k = 0; k < N_READ; ++k) {
        double *to = base + n * N_READ + k;
        if (read_rows[k] >= N_STATES) {
          *to = input[read_rows[k] - N_STATES];
          continue;
        }
        *to = free_row(change, input, fixed + n * NODE, read_rows[k]);
        if (t->on_fixed[d]) *to += free_row(memory, step->input, other + n * NODE, read_rows[k]);
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

/* What the commands make of the states of all directions, seen at a sample; `room` takes the changes of the held
   inputs, then those of the commands' memory, then the states kept for another try. */
static void begin_tangents(const tangents_of_run *t, in memory, in own, in row, in settings, in values,
                           long long samples, long long sample, double *room, long long *iw, double *w) {
  double *own_changes = room + t->directions * N_PARTS * N_HELD, *kept = own_changes + t->directions * N_OWN;
  for (long long k = 0; k < t->directions * CARRIED; ++k) kept[k] = t->memory[k];
  for (long long d = 0; d < t->directions; ++d) {
    double change[N_MEMORY + BLANK] = {0};
    for (int k = 0; k < CARRIED; ++k) change[k] = t->memory[d * CARRIED + k];
    in arg[] = {memory, own, row, settings, values, change, t->own + d * N_OWN, t->settings + d * N_SETTINGS,
                t->values + d * N_VALUES};
    double *res[] = {own_changes + d * N_OWN, room + d * N_PARTS * N_HELD,
                     t->seen + (d * samples + sample) * N_BEFORE};
    feeddrive_before_tangent(arg, res, iw, w, 0);
  }
}

static void restore_tangents(const tangents_of_run *t, in room) {
  in kept = room + t->directions * (N_PARTS * N_HELD + N_OWN);
  for (long long k = 0; k < t->directions * CARRIED; ++k) t->memory[k] = kept[k];
}

static void finish_tangents(const tangents_of_run *t, in room) {
  in own_changes = room + t->directions * N_PARTS * N_HELD;
  for (long long k = 0; k < t->directions * N_OWN; ++k) t->own[k] = own_changes[k];
}
#else
#define begin_tangents(...)
#define move_tangents(...)
#define restore_tangents(...)
#define finish_tangents(...)
#endif
