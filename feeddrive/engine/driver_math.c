/* Functions of math.h that are called for every number, in the place of the call; the results are the same, of tanh to
 * rounding.
 *
 * exp takes long over numbers too small to be told from 0, and a friction curve asks for little else at speed; fmod
 * takes long over ticks; tanh takes three times as long as the one exp that it needs, and every friction has one at
 * each node. A number that is none passes on, and the step is refused.
 */
#include <math.h>

static inline double quick_exp(double x) { return x < -746.0 ? 0.0 : exp(x); }

/* (1 - e) / (1 + e) with e = exp(-2 |x|), which loses the digits of a small x: there its series, the first term left
 * out is a fiftieth of the rounding at the seam. Within four units in the last place. */
static inline double quick_tanh(double x) {
  const double size = fabs(x), square = x * x;
  if (size < 0.125) {
    double rest = 21844.0 / 6081075 - square * (929569.0 / 638512875);
    rest = 62.0 / 2835 + square * (-1382.0 / 155925 + square * rest);
    rest = -1.0 / 3 + square * (2.0 / 15 + square * (-17.0 / 315 + square * rest));
    return x + x * square * rest;
  }
  if (size > 20.0) return copysign(1.0, x); /* 1 - tanh(20) is a thirteenth of the rounding */
  double left = exp(-2.0 * size);
  return copysign((1.0 - left) / (1.0 + left), x);
}

static inline double quick_fmod(double x, double y) {
  const double limit = 9007199254740992.0; /* 2^53: the quotient of whole numbers below it is cut off rightly */
  if (x != trunc(x) || y != trunc(y) || !(fabs(x) < limit) || !(fabs(y) < limit)) return fmod(x, y);
  return x - trunc(x / y) * y;
}

/* The larger is taken without a jump, which nobody could foretell; that there is no number can be. */
static inline double quick_fmax(double x, double y) {
  double most = x > y ? x : y;
  return x != x ? x : most;
}
static inline double quick_fmin(double x, double y) {
  double least = x < y ? x : y;
  return x != x ? x : least;
}

#define exp quick_exp
#define tanh quick_tanh
#define fmod quick_fmod
#define fmax quick_fmax
#define fmin quick_fmin
#define CASADI_SYMBOL_EXPORT static
