// Cameras, quaternions, an IMU step, the plane.
#pragma once
#include "pose.h"

template <class T>
void between_se3_whitened(const T *x, const T *y, const double *z, const double *S, T *out)
{
    T error[6];
    between_se3(x, y, z, error);
    for (int i = 0; i < 6; i++) {
        out[i] = S[7 * i] * error[i];
        for (int j = i + 1; j < 6; j++) out[i] += S[6 * i + j] * error[j];
    }
}

template <class T> void between_se2(const T *x, const T *y, const double *z, T *out)
{
    const T c = x[0] * y[0] + x[1] * y[1], s = x[0] * y[1] - x[1] * y[0], p = y[2] - x[2], q = y[3] - x[3];
    const T u = x[0] * p + x[1] * q - z[2], v = x[0] * q - x[1] * p - z[3];
    const T a = z[0] * c + z[1] * s, b = z[0] * s - z[1] * c, t = z[0] * u + z[1] * v, r = z[0] * v - z[1] * u;
    const T angle = atan2(b, a), half = angle / 2.0;
    const T k = abs(angle) > 1e-4 ? T(half * (1.0 + a) / b) : T(1.0 - angle * angle / 12.0);
    out[0] = k * t + half * r;
    out[1] = k * r - half * t;
    out[2] = angle;
}

template <class T> void bearing_range_se2_r2(const T *x, const T *p, const double *z, T *out)
{
    const T u = p[0] - x[2], v = p[1] - x[3];
    out[0] = atan2(x[0] * v - x[1] * u, x[0] * u + x[1] * v) - z[0];
    out[1] = sqrt(u * u + v * v) - z[1];
}

template <class T> void reprojection_bal(const T *x, const T *K, const T *p, T *out)
{
    T q[3];
    rotate(x, p, q);
    for (int k = 0; k < 3; k++) q[k] += x[4 + k];
    const T u = -q[0] / q[2], v = -q[1] / q[2], r2 = u * u + v * v;
    const T scale = K[0] * (1.0 + r2 * (K[1] + K[2] * r2));
    out[0] = scale * u;
    out[1] = scale * v;
}

template <class T> void quaternion_local(const T *q0, const T *q1, T *out)
{
    T apart[4];
    quotient(q0, q1, apart);
    log_rotation(apart, out);
}

template <class T> void quaternion_interpolation(const T *q0, const T *q1, const double *a, T *out)
{
    T w[3], turn[4];
    quaternion_local(q0, q1, w);
    for (int k = 0; k < 3; k++) w[k] *= a[0];
    exp_rotation(w, turn);
    multiply(q0, turn, out);
}
