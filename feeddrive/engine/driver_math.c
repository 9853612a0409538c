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

static inline double quick_fmax(double x, double y) { return (x > y || x != x) ? x : y; }
static inline double quick_fmin(double x, double y) { return (x < y || x != x) ? x : y; }

#define exp quick_exp
#define fmod quick_fmod
#define fmax quick_fmax
#define fmin quick_fmin
#define CASADI_SYMBOL_EXPORT static
