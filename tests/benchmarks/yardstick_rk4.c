/* Explicit: the classical Runge-Kutta scheme; springs change their lines at the end of a step. */
#include "yardstick.h"

/* One body in (slip, rotation), all by hand. */
double rk4_one(double strength, double dt, int steps, table *t)
{
   const double l = HEIGHT, i_c = MASS * (l * l + DEPTH * DEPTH) / 12;
   const double a11 = 1 / MASS + l * l / (4 * i_c), a12 = -l / (2 * i_c), a22 = 1 / i_c;
   const law ws = shear_law(1, strength), wf = flexure_law(1);
   line s = virgin(ws), f = virgin(wf);
   double u = 0, r = 0, v = 0, w = 0, peak = 0, p1 = t->force[0];

   for (int step = 0; step < steps; step++) {
      const double p0 = p1, p_half = force_at(t, (step + 0.5) * dt);
      p1 = force_at(t, (step + 1) * dt);

      double ru = p0 - (s.c + s.k * u), rr = p0 * l - (f.c + f.k * r);
      const double a1 = a11 * ru + a12 * rr, b1 = a12 * ru + a22 * rr;
      const double v2 = v + 0.5 * dt * a1, w2 = w + 0.5 * dt * b1;

      ru = p_half - (s.c + s.k * (u + 0.5 * dt * v));
      rr = p_half * l - (f.c + f.k * (r + 0.5 * dt * w));
      const double a2 = a11 * ru + a12 * rr, b2 = a12 * ru + a22 * rr;
      const double v3 = v + 0.5 * dt * a2, w3 = w + 0.5 * dt * b2;

      ru = p_half - (s.c + s.k * (u + 0.5 * dt * v2));
      rr = p_half * l - (f.c + f.k * (r + 0.5 * dt * w2));
      const double a3 = a11 * ru + a12 * rr, b3 = a12 * ru + a22 * rr;
      const double v4 = v + dt * a3, w4 = w + dt * b3;

      ru = p1 - (s.c + s.k * (u + dt * v3));
      rr = p1 * l - (f.c + f.k * (r + dt * w3));
      const double a4 = a11 * ru + a12 * rr, b4 = a12 * ru + a22 * rr;

      u += dt / 6 * (v + 2 * (v2 + v3) + v4);
      r += dt / 6 * (w + 2 * (w2 + w3) + w4);
      v += dt / 6 * (a1 + 2 * (a2 + a3) + a4);
      w += dt / 6 * (b1 + 2 * (b2 + b3) + b4);
      follow(&s, &ws, u);
      follow(&f, &wf, r);
      see_peak(&peak, u + l * r);
   }
   return peak;
}

/* Springs of a chain, as arrays for the loops that every stage runs. */
typedef struct {
   double *c, *k, *first, *last, *way;
   law w;
} springs;

static springs new_springs(int n, law w)
{
   springs s = {array(n), array(n), array(n), array(n), array(n), w};
   for (int i = 0; i < n; i++) {
      s.k[i] = w.k;
      s.first[i] = -w.d_y;
      s.last[i] = w.d_y;
   }
   return s;
}

static void change_spring(springs *s, int i, double d)
{
   line one = {s->c[i], s->k[i], s->first[i], s->last[i], (int)s->way[i]};
   change_line(&one, &s->w, d);
   s->c[i] = one.c;
   s->k[i] = one.k;
   s->first[i] = one.first;
   s->last[i] = one.last;
   s->way[i] = one.way;
}

static void follow_all(springs *s, int n, const double *restrict d)
{
   double *restrict first = s->first, *restrict last = s->last;
   const double *restrict way = s->way;

   for (int i = 0; i < n; i++) {
      if (d[i] < first[i] || d[i] > last[i]) change_spring(s, i, d[i]);
      first[i] = way[i] > 0 ? d[i] : first[i];
      last[i] = way[i] < 0 ? d[i] : last[i];
   }
}

/* Forces of the joints at a state; above the last body stands the load. */
static inline void joint_forces(int n, double h, const double *restrict x, const double *restrict r,
                                const springs *s, const springs *f, double p, double *restrict shear,
                                double *restrict moment)
{
   const double *restrict cs = s->c, *restrict ks = s->k, *restrict cf = f->c, *restrict kf = f->k;

   shear[0] = cs[0] + ks[0] * (x[0] - h * r[0]);
   moment[0] = cf[0] + kf[0] * r[0];
   for (int i = 1; i < n; i++) {
      shear[i] = cs[i] + ks[i] * ((x[i] - h * r[i]) - (x[i - 1] + h * r[i - 1]));
      moment[i] = cf[i] + kf[i] * (r[i] - r[i - 1]);
   }
   shear[n] = p;
   moment[n] = 0;
}

double rk4_chain(double strength, int n, double dt, int steps, table *t)
{
   const double l = HEIGHT / n, h = l / 2, m = MASS / n;
   const double per_mass = 1 / m, per_inertia = 12 / (m * (l * l + DEPTH * DEPTH));
   springs s = new_springs(n, shear_law(n, strength)), f = new_springs(n, flexure_law(n));
   double *restrict x = array(n), *restrict r = array(n), *restrict v = array(n), *restrict w = array(n);
   double *restrict xs = array(n), *restrict rs = array(n), *restrict vs = array(n);
   double *restrict ws = array(n), *restrict dx = array(n), *restrict dr = array(n);
   double *restrict dv = array(n), *restrict dw = array(n);
   double *restrict shear = array(n + 1), *restrict moment = array(n + 1);
   double peak = 0, p[3] = {0, 0, t->force[0]};

   for (int step = 0; step < steps; step++) {
      p[0] = p[2];
      p[1] = force_at(t, (step + 0.5) * dt);
      p[2] = force_at(t, (step + 1) * dt);

#define ACCELERATE(i)                                                                                  \
   const double a = (shear[i + 1] - shear[i]) * per_mass;                                              \
   const double b = (h * (shear[i] + shear[i + 1]) + (moment[i + 1] - moment[i])) * per_inertia;

      joint_forces(n, h, x, r, &s, &f, p[0], shear, moment);
      for (int i = 0; i < n; i++) {
         ACCELERATE(i)
         dx[i] = v[i];
         dr[i] = w[i];
         dv[i] = a;
         dw[i] = b;
         xs[i] = x[i] + 0.5 * dt * v[i];
         rs[i] = r[i] + 0.5 * dt * w[i];
         vs[i] = v[i] + 0.5 * dt * a;
         ws[i] = w[i] + 0.5 * dt * b;
      }
      for (int stage = 1; stage <= 2; stage++) {
         const double reach = stage == 1 ? 0.5 * dt : dt;
         joint_forces(n, h, xs, rs, &s, &f, p[1], shear, moment);
         for (int i = 0; i < n; i++) {
            ACCELERATE(i)
            dx[i] += 2 * vs[i];
            dr[i] += 2 * ws[i];
            dv[i] += 2 * a;
            dw[i] += 2 * b;
            xs[i] = x[i] + reach * vs[i];
            rs[i] = r[i] + reach * ws[i];
            vs[i] = v[i] + reach * a;
            ws[i] = w[i] + reach * b;
         }
      }
      joint_forces(n, h, xs, rs, &s, &f, p[2], shear, moment);
      for (int i = 0; i < n; i++) {
         ACCELERATE(i)
         x[i] += dt / 6 * (dx[i] + vs[i]);
         r[i] += dt / 6 * (dr[i] + ws[i]);
         v[i] += dt / 6 * (dv[i] + a);
         w[i] += dt / 6 * (dw[i] + b);
      }
      deform(n, h, x, r, xs, rs);
      follow_all(&s, n, xs);
      follow_all(&f, n, rs);
      see_peak(&peak, x[n - 1] + h * r[n - 1]);
   }
   return peak;
}
