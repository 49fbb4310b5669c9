/* The fastest RK4 step for one ellipsoid on the plane z = 0 that its author could write by hand: support point,
   angular velocity in body axes, the force eliminated, nothing general. The yardstick of the smooth step.
   State: p (3), quaternion w x y z (4), v (3), w (3). Parameters: a^2, b^2, c^2, 1/m, I (3), g. */
#include <math.h>

typedef struct {
  double a2, b2, c2, mi, Ix, Iy, Iz, g;
} body;

static inline void slope(const body *B, const double *restrict s, double *restrict k) {
  const double qw = s[3], qx = s[4], qy = s[5], qz = s[6], wx = s[10], wy = s[11], wz = s[12];
  /* n = R^T e_z: the plane's normal in body axes */
  const double nx = 2 * (qx * qz - qw * qy), ny = 2 * (qy * qz + qw * qx), nz = 1 - 2 * (qx * qx + qy * qy);
  const double ax = B->a2 * nx, ay = B->b2 * ny, az = B->c2 * nz;
  const double hi = 1 / sqrt(nx * ax + ny * ay + nz * az);
  /* contact point x = -A n / h, row J_w = x cross n */
  const double x = -ax * hi, y = -ay * hi, z = -az * hi;
  const double jx = y * nz - z * ny, jy = z * nx - x * nz, jz = x * ny - y * nx;
  /* n_dot = n cross w; h_dot = -(x . n_dot) */
  const double mx = ny * wz - nz * wy, my = nz * wx - nx * wz, mz = nx * wy - ny * wx;
  const double hd = -(x * mx + y * my + z * mz);
  /* Gamma2 = -h_ddot at zero acceleration: n_ddot = n_dot cross w */
  const double ox = my * wz - mz * wy, oy = mz * wx - mx * wz, oz = mx * wy - my * wx;
  const double gamma =
      x * ox + y * oy + z * oz - (B->a2 * mx * mx + B->b2 * my * my + B->c2 * mz * mz - hd * hd) * hi;
  const double ux = (B->Iy - B->Iz) * wy * wz / B->Ix, uy = (B->Iz - B->Ix) * wz * wx / B->Iy,
               uz = (B->Ix - B->Iy) * wx * wy / B->Iz;
  const double ix = jx / B->Ix, iy = jy / B->Iy, iz = jz / B->Iz;
  const double force = (B->g - gamma - jx * ux - jy * uy - jz * uz) / (B->mi + jx * ix + jy * iy + jz * iz);
  k[0] = s[7], k[1] = s[8], k[2] = s[9];
  k[3] = -0.5 * (qx * wx + qy * wy + qz * wz), k[4] = 0.5 * (qw * wx + qy * wz - qz * wy);
  k[5] = 0.5 * (qw * wy + qz * wx - qx * wz), k[6] = 0.5 * (qw * wz + qx * wy - qy * wx);
  k[7] = 0, k[8] = 0, k[9] = force * B->mi - B->g;
  k[10] = ux + ix * force, k[11] = uy + iy * force, k[12] = uz + iz * force;
}

void hand_written_steps(const body *B, double *s, double h, long n) {
  double k1[13], k2[13], k3[13], k4[13], y[13];
  for (long step = 0; step < n; step++) {
    slope(B, s, k1);
    for (int i = 0; i < 13; i++) y[i] = s[i] + h / 2 * k1[i];
    slope(B, y, k2);
    for (int i = 0; i < 13; i++) y[i] = s[i] + h / 2 * k2[i];
    slope(B, y, k3);
    for (int i = 0; i < 13; i++) y[i] = s[i] + h * k3[i];
    slope(B, y, k4);
    for (int i = 0; i < 13; i++) s[i] += h / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
  }
}
