/* Run one case:
 *
 *     yardstick rk4 N DT STEPS PERIOD STRENGTH      PERIOD: steps in a cycle of the load
 *     yardstick static POINTS
 *
 * prints nanoseconds of the processor per step (static: per increment) and the peak: displacement of
 * the top, with its sign [m] (static: force [N]).
 */
#include "yardstick.h"

#include <string.h>
#include <time.h>

static double seconds(void)
{
   return (double)clock() / CLOCKS_PER_SEC;
}

/* Both springs in series, from one end of a line to the next: exact. */
static double static_one(double strength, int points, const double *target)
{
   const double l = HEIGHT;
   const law ws = shear_law(1, strength), wf = flexure_law(1);
   line s = virgin(ws), f = virgin(wf);
   double u = 0, r = 0, x = 0, peak = 0;

   for (int i = 0; i < points; i++) {
      const int way = target[i] > x ? 1 : -1;

      if (s.way == -way) turn_back(&s, &ws);
      if (f.way == -way) turn_back(&f, &wf);
      while (x != target[i]) {
         /* Slip and rotation per displacement. */
         const double rate = 1 / (f.k + l * l * s.k), slip = f.k * rate, rotation = l * s.k * rate;
         const double far = target[i] - x;
         const double room_s = ((way > 0 ? s.last : s.first) - u) / slip;
         const double room_f = ((way > 0 ? f.last : f.first) - r) / rotation;

         if (fabs(room_s) < fabs(far) && fabs(room_s) <= fabs(room_f)) {
            r += rotation * room_s;
            u = way > 0 ? s.last : s.first;
            x = u + l * r;
            yield(&s, &ws, way);
         } else if (fabs(room_f) < fabs(far)) {
            u += slip * room_f;
            r = way > 0 ? f.last : f.first;
            x = u + l * r;
            yield(&f, &wf, way);
         } else {
            u += slip * far;
            r += rotation * far;
            x = target[i];
         }
      }
      if (s.way > 0) s.first = u;
      if (s.way < 0) s.last = u;
      if (f.way > 0) f.first = r;
      if (f.way < 0) f.last = r;
      see_peak(&peak, s.c + s.k * u);
   }
   return peak;
}

/* Cycles of the top that grow and fall, with smaller ones on them. */
static double *cycles(int points)
{
   double *x = array(points);
   for (int i = 1; i <= points; i++) {
      const double share = (double)i / points, angle = 2 * PI * 20 * share;
      x[i - 1] = 0.05 * sin(PI * share) * (sin(angle) + 0.2 * sin(7 * angle));
   }
   return x;
}

int main(int count, char **argument)
{
   double begin, peak;
   int steps;

   if (count == 3 && strcmp(argument[1], "static") == 0) {
      steps = atoi(argument[2]);
      double *target = cycles(steps);
      begin = seconds();
      peak = static_one(1.0, steps, target);
   } else if (count == 7) {
      const int n = atoi(argument[2]);
      const double dt = atof(argument[3]), strength = atof(argument[6]);
      steps = atoi(argument[4]);
      table t = new_table(dt, steps, atof(argument[5]));
      begin = seconds();
      if (n == 1) {
         peak = rk4_one(strength, dt, steps, &t);
      } else {
         peak = rk4_chain(strength, n, dt, steps, &t);
      }
   } else {
      fputs("usage: yardstick rk4 N DT STEPS PERIOD STRENGTH, or yardstick static POINTS\n", stderr);
      return 1;
   }
   printf("%.4f %.17g\n", 1e9 * (seconds() - begin) / steps, peak);
   return 0;
}
