/* Implicit: Newmark's average acceleration, Newton's method on the straight pieces of the springs. */
#include "yardstick.h"

/* A spring within a step: from the elastic line through its state at the begin, f = c + k d, cut off
 * by the two bounding lines. `side` tells which of the three holds. */
typedef struct {
   double *c, *f, *k, *side;
   law w;
} trial_springs;

static trial_springs new_trial_springs(int n, law w)
{
   trial_springs s = {array(n), array(n + 1), array(n), array(n), w};
   for (int i = 0; i < n; i++) s.k[i] = w.k;
   return s;
}

/* Forces and stiffnesses at a trial state; returns how many springs are on another line than before. */
static int try_all(trial_springs *s, int n, const double *restrict d)
{
   const double k = s->w.k, k_post = s->w.k_post, q = (k - k_post) * s->w.d_y;
   const double *restrict c = s->c;
   double *restrict f = s->f, *restrict stiffness = s->k, *restrict side = s->side;
   int changes = 0;

   for (int i = 0; i < n; i++) {
      const double elastic = c[i] + k * d[i], upper = k_post * d[i] + q, lower = k_post * d[i] - q;
      const double now = elastic > upper ? 1.0 : elastic < lower ? -1.0 : 0.0;
      f[i] = elastic > upper ? upper : elastic < lower ? lower : elastic;
      stiffness[i] = now == 0.0 ? k : k_post;
      changes += now != side[i];
      side[i] = now;
   }
   return changes;
}

static void keep_all(trial_springs *s, int n, const double *restrict d)
{
   for (int i = 0; i < n; i++) {
      s->c[i] = s->side[i] != 0.0 ? s->f[i] - s->w.k * d[i] : s->c[i];
   }
}

/* One body in (slip, rotation): the step is 2 x 2 equations for the increments U, R. */
double newmark_one(double strength, double dt, int steps, table *t)
{
   const double l = HEIGHT, i_c = MASS * (l * l + DEPTH * DEPTH) / 12, to_a = 4 / (dt * dt);
   const double m11 = MASS, m12 = MASS * l / 2, m22 = i_c + MASS * l * l / 4;
   const law ws = shear_law(1, strength), wf = flexure_law(1);
   const double qs = (ws.k - ws.k_post) * ws.d_y, qf = (wf.k - wf.k_post) * wf.d_y;
   double cs = 0, cf = 0, ks = ws.k, kf = wf.k, shear = 0, moment = 0, peak = 0;
   double u = 0, r = 0, v = 0, w = 0, a = 0, b = 0;
   int sides = 0, before;

   for (int step = 0; step < steps; step++) {
      const double p = force_at(t, (step + 1) * dt);
      const double gu = 4 / dt * v + a, gr = 4 / dt * w + b;
      double du = 0, dr = 0;

      do {
         const double au = gu - to_a * du, ar = gr - to_a * dr;
         const double ru = p - shear + m11 * au + m12 * ar, rr = p * l - moment + m12 * au + m22 * ar;
         const double k11 = to_a * m11 + ks, k12 = to_a * m12, k22 = to_a * m22 + kf;
         const double per_determinant = 1 / (k11 * k22 - k12 * k12);
         du += (k22 * ru - k12 * rr) * per_determinant;
         dr += (k11 * rr - k12 * ru) * per_determinant;

         before = sides;
         const double us = u + du, rs = r + dr;
         shear = cs + ws.k * us;
         moment = cf + wf.k * rs;
         ks = ws.k;
         kf = wf.k;
         sides = 0;
         if (shear > ws.k_post * us + qs) {
            shear = ws.k_post * us + qs;
            ks = ws.k_post;
            sides = 1;
         } else if (shear < ws.k_post * us - qs) {
            shear = ws.k_post * us - qs;
            ks = ws.k_post;
            sides = 2;
         }
         if (moment > wf.k_post * rs + qf) {
            moment = wf.k_post * rs + qf;
            kf = wf.k_post;
            sides += 4;
         } else if (moment < wf.k_post * rs - qf) {
            moment = wf.k_post * rs - qf;
            kf = wf.k_post;
            sides += 8;
         }
      } while (sides != before);

      u += du;
      r += dr;
      v = 2 / dt * du - v;
      w = 2 / dt * dr - w;
      a = to_a * du - gu;
      b = to_a * dr - gr;
      if (sides & 3) cs = shear - ws.k * u;
      if (sides & 12) cf = moment - wf.k * r;
      see_peak(&peak, u + l * r);
   }
   return peak;
}

/* Block factors of the chain: the inverse of the eliminated diagonal block times the block beside it,
 * and times the right side. */
typedef struct {
   double g11, g12, g21, g22, z1, z2;
} block;

/* Solve (4/dt^2 M + K) (X, R) = (p, q) from the ground up and back; joint i has the stiffnesses ks, kf. */
static void solve_chain(int n, double h, double m, double inertia, const double *restrict ks,
                        const double *restrict kf, const double *restrict p, const double *restrict q,
                        block *restrict b, double *restrict x, double *restrict r)
{
   double s11 = 0, s12 = 0, s22 = 0, t1 = 0, t2 = 0;

   for (int i = 0; i < n; i++) {
      /* From below: -B' S^-1 B and -B' S^-1 rhs of the body before, B = ks (-1, -h)' (1, -h) - kf. */
      s11 += m + ks[i];
      s12 -= h * ks[i];
      s22 += inertia + h * h * ks[i] + kf[i];
      t1 += p[i];
      t2 += q[i];
      const double ka = i + 1 < n ? ks[i + 1] : 0.0, kb = i + 1 < n ? kf[i + 1] : 0.0;
      s11 += ka;
      s12 += h * ka;
      s22 += h * h * ka + kb;
      const double d = 1 / (s11 * s22 - s12 * s12);
      const double b11 = -ka, b12 = h * ka, b21 = -h * ka, b22 = h * h * ka - kb;
      const double g11 = (s22 * b11 - s12 * b21) * d, g12 = (s22 * b12 - s12 * b22) * d;
      const double g21 = (s11 * b21 - s12 * b11) * d, g22 = (s11 * b22 - s12 * b12) * d;
      const double z1 = (s22 * t1 - s12 * t2) * d, z2 = (s11 * t2 - s12 * t1) * d;
      b[i] = (block){g11, g12, g21, g22, z1, z2};
      s11 = -(b11 * g11 + b21 * g21);
      s12 = -(b11 * g12 + b21 * g22);
      s22 = -(b12 * g12 + b22 * g22);
      t1 = -(b11 * z1 + b21 * z2);
      t2 = -(b12 * z1 + b22 * z2);
   }
   x[n - 1] = b[n - 1].z1;
   r[n - 1] = b[n - 1].z2;
   for (int i = n - 2; i >= 0; i--) {
      x[i] = b[i].z1 - b[i].g11 * x[i + 1] - b[i].g12 * r[i + 1];
      r[i] = b[i].z2 - b[i].g21 * x[i + 1] - b[i].g22 * r[i + 1];
   }
}

/* What a step of a chain needs. */
typedef struct {
   int n;
   double h, m, inertia, to_a;
   trial_springs s, f;
   double *x, *r, *gx, *gr, *dx, *dr, *xs, *rs, *u, *phi, *p, *q;
} chain;

/* Springs at the increments tried; returns how many are on another line than before. */
static int try_increments(chain *c)
{
   const double *restrict x = c->x, *restrict r = c->r, *restrict dx = c->dx, *restrict dr = c->dr;
   double *restrict xs = c->xs, *restrict rs = c->rs;

   for (int i = 0; i < c->n; i++) {
      xs[i] = x[i] + dx[i];
      rs[i] = r[i] + dr[i];
   }
   deform(c->n, c->h, xs, rs, c->u, c->phi);
   return try_all(&c->s, c->n, c->u) + try_all(&c->f, c->n, c->phi);
}

/* What is missing to equilibrium at the end of the step. */
static void find_residual(chain *c)
{
   const double *restrict sf = c->s.f, *restrict ff = c->f.f, *restrict gx = c->gx, *restrict gr = c->gr;
   const double *restrict dx = c->dx, *restrict dr = c->dr;
   double *restrict p = c->p, *restrict q = c->q;

   for (int i = 0; i < c->n; i++) {
      p[i] = sf[i + 1] - sf[i] + c->m * (gx[i] - c->to_a * dx[i]);
      q[i] = c->h * (sf[i] + sf[i + 1]) + (ff[i + 1] - ff[i]) + c->inertia * (gr[i] - c->to_a * dr[i]);
   }
}

/* Nothing but round-off is left: a spring on a bend may be on either line. */
static int is_small(const chain *c)
{
   double largest = 0;
   for (int i = 0; i < c->n; i++) largest = fmax(largest, fmax(fabs(c->p[i]), fabs(c->q[i])));
   return largest < 1e-9 * LOAD;
}

static double dot(int n, const double *restrict a, const double *restrict b)
{
   double sum = 0;
   for (int i = 0; i < n; i++) sum += a[i] * b[i];
   return sum;
}

/* The springs bend, and Newton's method can go back and forth over a bend: then as far on the last
 * correction (ex, er) as the energy falls, where the residual has no part along it. */
static void step_back(chain *c, const double *restrict ex, const double *restrict er, double before)
{
   double at = 1, lower = 0, upper = 1, lower_slope = before, upper_slope = 0;

   for (int i = 0; i < 20; i++) {
      const double slope = dot(c->n, c->p, ex) + dot(c->n, c->q, er);
      if (fabs(slope) <= 0.05 * before || (i == 0 && slope > 0)) break;
      if (slope > 0) {
         lower = at;
         lower_slope = slope;
         upper_slope *= 0.5;
      } else {
         upper = at;
         upper_slope = slope;
         lower_slope *= i > 0 ? 0.5 : 1.0;
      }
      const double next = lower + (upper - lower) * lower_slope / (lower_slope - upper_slope);
      for (int j = 0; j < c->n; j++) {
         c->dx[j] += (next - at) * ex[j];
         c->dr[j] += (next - at) * er[j];
      }
      at = next;
      try_increments(c);
      find_residual(c);
   }
}

double newmark_chain(double strength, int n, double dt, int steps, table *t)
{
   const double l = HEIGHT / n, h = l / 2, m = MASS / n, to_a = 4 / (dt * dt);
   const double inertia = m * (l * l + DEPTH * DEPTH) / 12;
   chain c = {n, h, m, inertia, to_a, new_trial_springs(n, shear_law(n, strength)),
              new_trial_springs(n, flexure_law(n)), array(n), array(n), array(n), array(n), array(n),
              array(n), array(n), array(n), array(n), array(n), array(n), array(n)};
   double *restrict v = array(n), *restrict w = array(n), *restrict a = array(n), *restrict b = array(n);
   double *restrict ex = array(n), *restrict er = array(n);
   block *restrict blocks = array(6 * (size_t)n);
   double peak = 0;

   for (int step = 0; step < steps; step++) {
      c.s.f[n] = force_at(t, (step + 1) * dt);
      for (int i = 0; i < n; i++) {
         c.gx[i] = 4 / dt * v[i] + a[i];
         c.gr[i] = 4 / dt * w[i] + b[i];
         c.dx[i] = 0;
         c.dr[i] = 0;
      }
      find_residual(&c);
      for (int iteration = 1, changes = 1; changes > 0; iteration++) {
         solve_chain(n, h, to_a * m, to_a * inertia, c.s.k, c.f.k, c.p, c.q, blocks, ex, er);
         for (int i = 0; i < n; i++) {
            c.dx[i] += ex[i];
            c.dr[i] += er[i];
         }
         const double before = iteration > 3 ? dot(n, c.p, ex) + dot(n, c.q, er) : 0;
         changes = try_increments(&c);
         if (changes > 0) find_residual(&c);
         if (changes > 0 && is_small(&c)) break;
         if (changes > 0 && iteration > 3) step_back(&c, ex, er, before);
         if (iteration == 1000) {
            fputs("yardstick: a step does not converge\n", stderr);
            exit(1);
         }
      }
      keep_all(&c.s, n, c.u);
      keep_all(&c.f, n, c.phi);
      for (int i = 0; i < n; i++) {
         c.x[i] = c.xs[i];
         c.r[i] = c.rs[i];
         v[i] = 2 / dt * c.dx[i] - v[i];
         w[i] = 2 / dt * c.dr[i] - w[i];
         a[i] = to_a * c.dx[i] - c.gx[i];
         b[i] = to_a * c.dr[i] - c.gr[i];
      }
      see_peak(&peak, c.x[n - 1] + h * c.r[n - 1]);
   }
   return peak;
}
