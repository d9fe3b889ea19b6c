// A step of IMU integration, and a camera that reads its rows out while it moves.
#pragma once
#include <cmath>

#include "sensors.h"

template <class T> void imu_step(const T *x, const T *u, const T *b, const double *dt, T *out)
{
    const double h = std::abs(dt[0]) * dt[0] / 2.0;
    T w[3], f[3], a[3], turn[4];
    for (int k = 0; k < 3; k++) {
        w[k] = (u[k] - b[k]) * dt[0];
        f[k] = u[3 + k] - b[3 + k];
    }
    rotate(x, f, a);
    exp_rotation(w, turn);
    multiply(x, turn, out);
    for (int k = 0; k < 3; k++) {
        out[4 + k] = x[4 + k] + x[7 + k] * dt[0] + a[k] * h;
        out[7 + k] = x[7 + k] + a[k] * dt[0];
    }
}

template <class T>
void rolling_shutter(const T *R, const T *p, const T *C, const T *c, const T *w, const T *v, const T *P,
                     const double *t, const double *K, const double *D, T *out)
{
    T turned[3], turn[4], body[4], camera[4], lever[3], ray[3], q[3];
    for (int k = 0; k < 3; k++) turned[k] = w[k] * t[0];
    exp_rotation(turned, turn);
    multiply(R, turn, body);
    rotate(body, c, lever);
    for (int k = 0; k < 3; k++) ray[k] = P[k] - p[k] - v[k] * t[0] - lever[k];
    multiply(body, C, camera);
    unrotate(camera, ray, q);
    const T m = q[0] / q[2], n = q[1] / q[2], r2 = m * m + n * n;
    const T radial = 1.0 + r2 * (D[0] + r2 * (D[1] + r2 * D[2]));
    out[0] = K[0] * (radial * m + 2.0 * D[3] * m * n + D[4] * (r2 + 2.0 * m * m)) + K[2];
    out[1] = K[1] * (radial * n + 2.0 * D[3] * (r2 + 2.0 * n * n) + D[4] * m * n) + K[3];
}
