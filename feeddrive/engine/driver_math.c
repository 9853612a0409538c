/* Functions of math.h that are called for every number, in the place of the call; the results are the same.
 *
 * exp takes long over numbers too small to be told from 0, and a friction curve asks for little else at speed; fmod
 * takes long over ticks. A number that is none passes on, and the step is refused.
 */
#include <math.h>

static inline double quick_exp(double x) { return x < -746.0 ? 0.0 : exp(x); }

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
#define fmod quick_fmod
#define fmax quick_fmax
#define fmin quick_fmin
#define CASADI_SYMBOL_EXPORT static
