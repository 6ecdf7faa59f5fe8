/* Sine and cosine that are the same on every processor: additions and multiplications in one order.
 *
 * C libraries differ in the last bit of theirs, and nothing else in a controller does: linked with this in
 * place of the library's, it gives the same commands everywhere, to the last bit. For |x| up to 1e5, which is
 * far for a joint; the error is below 1e-15. */

/* pi/2 in parts, the first two with few digits, so that multiples of them are exact. */
#define PART_1 1.5707963267341256
#define PART_2 6.077100506303966e-11
#define PART_3 2.0222662487959506e-21

double sin(double x);
double cos(double x);
void sincos(double x, double *sine, double *cosine); /* what compilers make of both */

/* For |x| <= pi/4 + 1e-6, and a correction that x has no digits for. */
static double near_sine(double x, double correction) {
  const double z = x * x;
  double sum = 1.0 / 355687428096000.0; /* 1/17! */
  sum = sum * z - 1.0 / 1307674368000.0;
  sum = sum * z + 1.0 / 6227020800.0;
  sum = sum * z - 1.0 / 39916800.0;
  sum = sum * z + 1.0 / 362880.0;
  sum = sum * z - 1.0 / 5040.0;
  sum = sum * z + 1.0 / 120.0;
  sum = sum * z - 1.0 / 6.0;
  return x + (x * z * sum + correction);
}

static double near_cosine(double x, double correction) {
  const double z = x * x;
  double sum = 1.0 / 20922789888000.0; /* 1/16! */
  sum = sum * z - 1.0 / 87178291200.0;
  sum = sum * z + 1.0 / 479001600.0;
  sum = sum * z - 1.0 / 3628800.0;
  sum = sum * z + 1.0 / 40320.0;
  sum = sum * z - 1.0 / 720.0;
  sum = sum * z + 1.0 / 24.0;
  return 1.0 - (0.5 * z - (z * z * sum - x * correction));
}

/* The sine of x + quarters * pi/2. */
static double turned_sine(double x, int quarters) {
  const double turns = x * 0.6366197723675814; /* 2/pi */
  const int nearest = (int)(turns < 0.0 ? turns - 0.5 : turns + 0.5);
  const double high = x - nearest * PART_1, low = nearest * PART_2;
  const double rest = high - low, correction = ((high - rest) - low) - nearest * PART_3;
  const unsigned turn = (unsigned)(nearest + quarters) % 4;
  const double value = turn % 2 ? near_cosine(rest, correction) : near_sine(rest, correction);
  return turn < 2 ? value : -value;
}

double sin(double x) {
  return turned_sine(x, 0);
}

double cos(double x) {
  return turned_sine(x, 1);
}

void sincos(double x, double *sine, double *cosine) {
  *sine = turned_sine(x, 0); /* not sin(x): compilers make this function of the two */
  *cosine = turned_sine(x, 1);
}
