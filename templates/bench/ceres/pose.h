// Factors of poses: rotation (x, y, z, w), then translation; of the plane (cos, sin, x, y).
#pragma once
#include "rotation.h"

template <class A, class B, class T> void relative(const A *x, const B *y, T *out)
{
    const T apart[3] = {y[4] - x[4], y[5] - x[5], y[6] - x[6]};
    quotient(x, y, out);
    unrotate(x, apart, out + 4);
}

// Log of a pose: t - w x t / 2 + D w x (w x t).
template <class T> void log_pose(const T *x, T *out)
{
    log_rotation(x, out);
    const T *w = out, *t = x + 4;
    const T s = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    T D = 1.0 / 12.0 + s / 720.0;
    if (s > 1e-8) {
        const T half = sqrt(s) / 2.0;
        D = (1.0 - half * cos(half) / sin(half)) / s;
    }
    const T u[3] = {w[1] * t[2] - w[2] * t[1], w[2] * t[0] - w[0] * t[2], w[0] * t[1] - w[1] * t[0]};
    out[3] = t[0] - u[0] / 2.0 + D * (w[1] * u[2] - w[2] * u[1]);
    out[4] = t[1] - u[1] / 2.0 + D * (w[2] * u[0] - w[0] * u[2]);
    out[5] = t[2] - u[2] / 2.0 + D * (w[0] * u[1] - w[1] * u[0]);
}

template <class T> void between_se3(const T *x, const T *y, const double *z, T *out)
{
    T seen[7], error[7];
    relative(x, y, seen);
    relative(z, seen, error);
    log_pose(error, out);
}

template <class T> void prior_se3(const T *x, const double *z, T *out)
{
    T error[7];
    relative(z, x, error);
    log_pose(error, out);
}

template <class T> void between_so3(const T *x, const T *y, const double *z, T *out)
{
    T seen[4], error[4];
    quotient(x, y, seen);
    quotient(z, seen, error);
    log_rotation(error, out);
}

template <class T> void between_so3xr3(const T *x, const T *y, const double *z, T *out)
{
    T seen[7], error[4];
    relative(x, y, seen);
    quotient(z, seen, error);
    log_rotation(error, out);
    for (int k = 0; k < 3; k++) out[3 + k] = seen[4 + k] - z[4 + k];
}
