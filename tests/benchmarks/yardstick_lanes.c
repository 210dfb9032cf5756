/* 64 columns of one body side by side, by hand: the classical Runge-Kutta scheme, or average acceleration, under
 * a motion of the ground, on straight lines that never end. No events, no energies, no peaks but that of the
 * displacement. What lanes with events are measured by.
 *
 *     yardstick_lanes rk4|newmark STEPS
 *
 * prints nanoseconds of the processor per column and step, and the peak of the first column [m].
 */
#include "yardstick.h"

#include <string.h>
#include <time.h>

enum { lanes = 64 };

typedef struct {
   double q[lanes], r[lanes], v[lanes], w[lanes], x[lanes], y[lanes], k[lanes], m[lanes], peak[lanes], scale[lanes];
} columns;

static double ground(int step)
{
   return 2.0 * sin(0.02 * step);
}

static void rk4(columns *c, double h, int steps)
{
   const double l = HEIGHT, i_c = MASS * (l * l + DEPTH * DEPTH) / 12;
   const double a11 = 1 / MASS + l * l / (4 * i_c), a12 = -l / (2 * i_c), a22 = 1 / i_c, b1 = MASS, b2 = MASS * l / 2;

   for (int step = 0; step < steps; step++) {
      const double g0 = ground(step), g2 = ground(step + 1), g1 = 0.5 * (g0 + g2);
      for (int j = 0; j < lanes; j++) {
         const double u = c->q[j], r = c->r[j], v = c->v[j], w = c->w[j], k = c->k[j], m = c->m[j], s = c->scale[j];
         double p = -b1 * g0 * s - k * u, t = -b2 * g0 * s - m * r;
         const double a1 = a11 * p + a12 * t, d1 = a12 * p + a22 * t, v2 = v + 0.5 * h * a1, w2 = w + 0.5 * h * d1;
         p = -b1 * g1 * s - k * (u + 0.5 * h * v), t = -b2 * g1 * s - m * (r + 0.5 * h * w);
         const double a2 = a11 * p + a12 * t, d2 = a12 * p + a22 * t, v3 = v + 0.5 * h * a2, w3 = w + 0.5 * h * d2;
         p = -b1 * g1 * s - k * (u + 0.5 * h * v2), t = -b2 * g1 * s - m * (r + 0.5 * h * w2);
         const double a3 = a11 * p + a12 * t, d3 = a12 * p + a22 * t, v4 = v + h * a3, w4 = w + h * d3;
         p = -b1 * g2 * s - k * (u + h * v3), t = -b2 * g2 * s - m * (r + h * w3);
         const double a4 = a11 * p + a12 * t, d4 = a12 * p + a22 * t;

         c->q[j] = u + h / 6 * (v + 2 * (v2 + v3) + v4);
         c->r[j] = r + h / 6 * (w + 2 * (w2 + w3) + w4);
         c->v[j] = v + h / 6 * (a1 + 2 * (a2 + a3) + a4);
         c->w[j] = w + h / 6 * (d1 + 2 * (d2 + d3) + d4);
         const double top = fabs(c->q[j] + l * c->r[j]);
         c->peak[j] = top > c->peak[j] ? top : c->peak[j];
      }
   }
}

/* In slip and rotation the mass is full; the inverse of the tangent is the same in all steps. */
static void newmark(columns *c, double h, int steps)
{
   const double l = HEIGHT, i_c = MASS * (l * l + DEPTH * DEPTH) / 12;
   const double m11 = MASS, m12 = MASS * l / 2, m22 = i_c + MASS * l * l / 4, f = 4 / (h * h);
   double e11[lanes], e12[lanes], e22[lanes];

   for (int j = 0; j < lanes; j++) {
      const double t11 = f * m11 + c->k[j], t12 = f * m12, t22 = f * m22 + c->m[j], d = 1 / (t11 * t22 - t12 * t12);
      e11[j] = t22 * d, e12[j] = -t12 * d, e22[j] = t11 * d;
   }
   for (int step = 0; step < steps; step++) {
      const double g = ground(step + 1);
      for (int j = 0; j < lanes; j++) {
         const double v = c->v[j], w = c->w[j], a = c->x[j], b = c->y[j];
         const double s = 4 / h * v + a, t = 4 / h * w + b;
         const double p = -m11 * g * c->scale[j] - c->k[j] * c->q[j] + m11 * s + m12 * t;
         const double o = -m12 * g * c->scale[j] - c->m[j] * c->r[j] + m12 * s + m22 * t;
         const double du = e11[j] * p + e12[j] * o, dr = e12[j] * p + e22[j] * o;
         c->q[j] += du;
         c->r[j] += dr;
         c->x[j] = f * du - s;
         c->y[j] = f * dr - t;
         c->v[j] = v + 0.5 * h * (a + c->x[j]);
         c->w[j] = w + 0.5 * h * (b + c->y[j]);
         const double top = fabs(c->q[j] + l * c->r[j]);
         c->peak[j] = top > c->peak[j] ? top : c->peak[j];
      }
   }
}

int main(int count, char **argument)
{
   static columns c;

   if (count != 3) {
      fputs("usage: yardstick_lanes rk4|newmark STEPS\n", stderr);
      return 1;
   }
   const int steps = atoi(argument[2]);
   for (int j = 0; j < lanes; j++) {
      c.k[j] = 7.0387e8;
      c.m[j] = 2.5428e8;
      c.scale[j] = 0.5 + j / 64.0;
   }
   const clock_t begin = clock();
   if (strcmp(argument[1], "rk4") == 0) {
      rk4(&c, 5e-5, steps);
   } else {
      newmark(&c, 5e-3, steps);
   }
   const double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
   printf("%.4f %.17g\n", 1e9 * seconds / steps / lanes, c.peak[0]);
   return 0;
}
