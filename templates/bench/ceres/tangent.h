// Jets that are seeded with the tangent of a right perturbation: storage in, d storage / d tangent beside it.
#pragma once
#include "rotation.h"

template <class J> void seed_vector(const double *a, int size, int column, J *out)
{
    for (int k = 0; k < size; k++) out[k] = J(a[k], column + k);
}

template <class J> void seed_rotation(const double *q, int column, J *out)
{
    const double x = q[0] / 2, y = q[1] / 2, z = q[2] / 2, w = q[3] / 2;
    const double slope[4][3] = { {w, -z, y}, {z, w, -x}, {-y, x, w}, {-x, -y, -z} };
    for (int i = 0; i < 4; i++) {
        out[i] = J(q[i]);
        for (int j = 0; j < 3; j++) out[i].v[column + j] = slope[i][j];
    }
}

template <class J> void seed_pose(const double *x, int column, J *out)
{
    seed_rotation(x, column, out);
    for (int i = 0; i < 3; i++) out[4 + i] = J(x[4 + i]);
    for (int j = 0; j < 3; j++) {
        const double unit[3] = {double(j == 0), double(j == 1), double(j == 2)};
        double axis[3];
        rotate(x, unit, axis);
        for (int i = 0; i < 3; i++) out[4 + i].v[column + 3 + j] = axis[i];
    }
}

template <class J> void seed_planar(const double *x, int column, J *out)
{
    for (int i = 0; i < 4; i++) out[i] = J(x[i]);
    out[0].v[column + 2] = -x[1];
    out[1].v[column + 2] = x[0];
    out[2].v[column] = out[3].v[column + 1] = x[0];
    out[3].v[column] = x[1];
    out[2].v[column + 1] = -x[1];
}

// d Log(q^-1 q(d)) = 2 vec(q^-1 dq), as derivatives of three numbers.
template <class J> void rotation_tangent(const J *q, J *out)
{
    const double x = q[0].a, y = q[1].a, z = q[2].a, w = q[3].a;
    out[0].v = 2 * (w * q[0].v + z * q[1].v - y * q[2].v - x * q[3].v);
    out[1].v = 2 * (w * q[1].v - z * q[0].v + x * q[2].v - y * q[3].v);
    out[2].v = 2 * (w * q[2].v + y * q[0].v - x * q[1].v - z * q[3].v);
}

template <class J> void store_block(const J *rows, int count, int column, int columns, double *b)
{
    for (int i = 0; i < count; i++)
        for (int j = 0; j < columns; j++) b[i * columns + j] = rows[i].v[column + j];
}
