/* What one would write by hand for one job: the least that the machine can do, to measure rbsdem by.
 *
 * A uniform chain of n bodies for small rotations, two bilinear springs with kinematic hardening in each
 * joint, a lateral force at the top tabulated at every twentieth step. No other kinematics, no other
 * spring, no damping, no energy balance, no output, no checks. `benchmark.py` runs the same.
 *
 * Body i has the displacement x of its centroid and the rotation r; joint i is at its bottom, half a
 * body h below. Slip u_i = (x_i - h r_i) - (x_{i-1} + h r_{i-1}), rotation phi_i = r_i - r_{i-1}. SI.
 */
#ifndef YARDSTICK_H
#define YARDSTICK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Column 1 of table 3 with a bilinear flexural spring; depth for the rotary inertia. SI. */
#define HEIGHT 1.6
#define MASS 614.4
#define DEPTH 0.4
#define LOAD 150e3
#define PI 3.14159265358979323846

/* A joint takes 1/n of the deformation of the whole column. The strength is that of the shear springs,
 * 1 as in the paper. */
typedef struct {
   double k, k_post, d_y;
} law;

static inline law shear_law(int n, double strength)
{
   law w = {n * 7.0387e8, n * 8.3185e6, strength * 1.296e-4 / n};
   return w;
}

static inline law flexure_law(int n)
{
   law w = {n * 6.2937e7, n * 7.5772e6, 2.7183e-3 / n};
   return w;
}

static inline void *array(size_t count)
{
   double *a = calloc(count, sizeof *a);
   if (a == NULL) {
      fputs("yardstick: out of memory\n", stderr);
      exit(1);
   }
   return a;
}

/* --- Load ----------------------------------------------------------------------------------------- */

enum { spacing = 20 };

typedef struct {
   int points, at;
   double *time, *force, slope;
} table;

static inline table new_table(double dt, int steps, double period)
{
   table t = {steps / spacing + 1, 0, NULL, NULL, 0.0};
   t.time = array(t.points);
   t.force = array(t.points);
   for (int i = 0; i < t.points; i++) {
      t.time[i] = i * spacing * dt;
      t.force[i] = LOAD * sin(2 * PI * i * spacing / period);
   }
   t.slope = (t.force[1] - t.force[0]) / (t.time[1] - t.time[0]);
   return t;
}

static inline double force_at(table *t, double time)
{
   while (time > t->time[t->at + 1] && t->at + 2 < t->points) {
      t->at++;
      t->slope = (t->force[t->at + 1] - t->force[t->at]) / (t->time[t->at + 1] - t->time[t->at]);
   }
   return t->force[t->at] + t->slope * (time - t->time[t->at]);
}

/* --- Spring: the line f = c + k d from `first` to `last` ----------------------------------------- */

/* A spring that yields goes one way, +1 or -1, and leaves the line where it turns back. */
typedef struct {
   double c, k, first, last;
   int way;
} line;

static inline line virgin(law w)
{
   line s = {0.0, w.k, -w.d_y, w.d_y, 0};
   return s;
}

static inline void yield(line *s, const law *w, int way)
{
   s->c = way * (w->k - w->k_post) * w->d_y;
   s->k = w->k_post;
   if (way > 0) s->first = s->last;
   if (way < 0) s->last = s->first;
   if (way > 0) s->last = INFINITY;
   if (way < 0) s->first = -INFINITY;
   s->way = way;
}

static inline void turn_back(line *s, const law *w)
{
   const double d = s->way > 0 ? s->first : s->last;

   s->c += (s->k - w->k) * d;
   s->k = w->k;
   s->first = s->way > 0 ? d - 2 * w->d_y : d;
   s->last = s->way > 0 ? d : d + 2 * w->d_y;
   s->way = 0;
}

static inline void change_line(line *s, const law *w, double d)
{
   if (s->way != 0) turn_back(s, w);
   if (d > s->last) yield(s, w, 1);
   if (d < s->first) yield(s, w, -1);
}

static inline void follow(line *s, const law *w, double d)
{
   if (d < s->first || d > s->last) change_line(s, w, d);
   if (s->way > 0) s->first = d;
   if (s->way < 0) s->last = d;
}

static inline void see_peak(double *peak, double top)
{
   if (fabs(top) > fabs(*peak)) *peak = top;
}

/* Deformations of the joints. */
static inline void deform(int n, double h, const double *restrict x, const double *restrict r,
                          double *restrict u, double *restrict phi)
{
   u[0] = x[0] - h * r[0];
   phi[0] = r[0];
   for (int i = 1; i < n; i++) {
      u[i] = (x[i] - h * r[i]) - (x[i - 1] + h * r[i - 1]);
      phi[i] = r[i] - r[i - 1];
   }
}

double rk4_one(double strength, double dt, int steps, table *t);
double rk4_chain(double strength, int n, double dt, int steps, table *t);

#endif
