// Quaternions (x, y, z, w) of doubles and Jets, on Ceres' own functions, which put w first.
#pragma once
#include <ceres/jet.h>
#include <ceres/rotation.h>

template <class A, class B, class T> void multiply(const A *a, const B *b, T *ab)
{
    ab[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
    ab[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
    ab[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
    ab[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
}

template <class A> void conjugate(const A *a, A *out)
{
    for (int k = 0; k < 3; k++) out[k] = -a[k];
    out[3] = a[3];
}

template <class A, class B, class T> void quotient(const A *a, const B *b, T *out)
{
    A inverse[4];
    conjugate(a, inverse);
    multiply(inverse, b, out);
}

template <class A, class P, class T> void rotate(const A *q, const P *p, T *out)
{
    T u[3] = {q[1] * p[2] - q[2] * p[1], q[2] * p[0] - q[0] * p[2], q[0] * p[1] - q[1] * p[0]};
    for (int k = 0; k < 3; k++) u[k] += u[k];
    out[0] = p[0] + q[3] * u[0] + q[1] * u[2] - q[2] * u[1];
    out[1] = p[1] + q[3] * u[1] + q[2] * u[0] - q[0] * u[2];
    out[2] = p[2] + q[3] * u[2] + q[0] * u[1] - q[1] * u[0];
}

template <class A, class P, class T> void unrotate(const A *q, const P *p, T *out)
{
    A inverse[4];
    conjugate(q, inverse);
    rotate(inverse, p, out);
}

template <class T> void log_rotation(const T *q, T *w)
{
    const T wxyz[4] = {q[3], q[0], q[1], q[2]};
    ceres::QuaternionToAngleAxis(wxyz, w);
}

template <class T> void exp_rotation(const T *w, T *q)
{
    T wxyz[4];
    ceres::AngleAxisToQuaternion(w, wxyz);
    for (int k = 0; k < 4; k++) q[k] = wxyz[(k + 1) % 4];
}
