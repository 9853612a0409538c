/* Steps of the explicit scheme at one place of the nut: x' = s + A x, with A in bands.

   A band holds the entries of A whose column is row + offset, from row `first` on; the first band is the diagonal, over
   all rows. What goes to the air in a step, leak . x - gained, is summed beside. Rows are treated in blocks, so that
   what a block needs stays in the nearest cache. */

#include <stdlib.h> /* tells whether the C library is one that can choose between versions of a function */

typedef struct {
    long long offset, first, count;
    const double *value;
} band;

typedef struct {
    long long nodes, bands, leaks;
    const band *band;
    const double *source;
    const long long *leak_at;
    const double *leak;
    double gained;
} place;

#define BLOCK 200

/* Wide registers where the processor has them; each row's sum is the same either way. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

static double lost_of(const place *p, const double *x)
{
    double sum[4] = {0, 0, 0, 0};
    long long i;
    for (i = 0; i + 4 <= p->leaks; i += 4) {
        sum[0] += p->leak[i] * x[p->leak_at[i]];
        sum[1] += p->leak[i + 1] * x[p->leak_at[i + 1]];
        sum[2] += p->leak[i + 2] * x[p->leak_at[i + 2]];
        sum[3] += p->leak[i + 3] * x[p->leak_at[i + 3]];
    }
    for (; i < p->leaks; i++)
        sum[0] += p->leak[i] * x[p->leak_at[i]];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* What a row takes from its four neighbours in the grid, in one pass. */
WIDE static void add_four(const band *const *b, long long low, long long high, const double *restrict x,
                          double *restrict y)
{
    const double *v0 = b[0]->value - b[0]->first, *v1 = b[1]->value - b[1]->first;
    const double *v2 = b[2]->value - b[2]->first, *v3 = b[3]->value - b[3]->first;
    const double *x0 = x + b[0]->offset, *x1 = x + b[1]->offset, *x2 = x + b[2]->offset, *x3 = x + b[3]->offset;
    for (long long row = low; row < high; row++)
        y[row] += (v0[row] * x0[row] + v1[row] * x1[row]) + (v2[row] * x2[row] + v3[row] * x3[row]);
}

static void add_one(const band *b, long long low, long long high, const double *restrict x, double *restrict y)
{
    long long from = b->first > low ? b->first : low;
    long long to = b->first + b->count < high ? b->first + b->count : high;
    const double *value = b->value - b->first;
    const double *shifted = x + b->offset;
    for (long long row = from; row < to; row++)
        y[row] += value[row] * shifted[row];
}

WIDE static void begin(const place *p, long long low, long long high, const double *restrict x, double *restrict y)
{
    const double *diagonal = p->band[0].value, *source = p->source;
    for (long long row = low; row < high; row++)
        y[row] = source[row] + diagonal[row] * x[row];
}

static void block(const place *p, long long low, long long high, const double *restrict x, double *restrict y)
{
    const band *whole[4];
    int count = 0;
    begin(p, low, high, x, y);
    for (long long i = 1; i < p->bands; i++) {
        const band *b = &p->band[i];
        if (b->first > low || b->first + b->count < high) {
            add_one(b, low, high, x, y);
            continue;
        }
        whole[count++] = b;
        if (count == 4) {
            add_four(whole, low, high, x, y);
            count = 0;
        }
    }
    for (int i = 0; i < count; i++)
        add_one(whole[i], low, high, x, y);
}

/* `x` holds the state before and after, `y` is work; `total` gathers the states after each step unless it is null. */
void feeddrive_march(const place *p, long long steps, double *x, double *y, double *lost, double *total)
{
    double *before = x, *after = y, *other;
    for (long long step = 0; step < steps; step++) {
        *lost += lost_of(p, before) - p->gained;
        for (long long low = 0; low < p->nodes; low += BLOCK) {
            long long high = low + BLOCK < p->nodes ? low + BLOCK : p->nodes;
            block(p, low, high, before, after);
            if (total)
                for (long long row = low; row < high; row++)
                    total[row] += after[row];
        }
        other = before;
        before = after;
        after = other;
    }
    if (before != x)
        for (long long row = 0; row < p->nodes; row++)
            x[row] = y[row];
}
