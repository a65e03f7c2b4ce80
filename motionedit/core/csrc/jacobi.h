/* Eigenvectors of small symmetric matrices. */

#ifndef MOTIONEDIT_JACOBI_H
#define MOTIONEDIT_JACOBI_H

#include <math.h>
#include <string.h>

/* Squared, of the off-diagonal part to the whole: Jacobi's rotations have come to their end. */
#define DIAGONAL 1e-28
#define SWEEPS 30

/* Leave eigenvalues on the diagonal of S, (k, k), and eigenvectors in the columns of U, by cyclic Jacobi rotations. */
static void jacobi(double *S, int k, double *U)
{
    memset(U, 0, sizeof(double) * k * k);
    for (int i = 0; i < k; i++)
        U[i * k + i] = 1.0;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        double off = 0.0, whole = 0.0;
        for (int i = 0; i < k; i++)
            for (int j = 0; j < k; j++)
                whole += S[i * k + j] * S[i * k + j], off += i == j ? 0.0 : S[i * k + j] * S[i * k + j];
        if (off <= DIAGONAL * whole)
            return;
        for (int p = 0; p < k; p++)
            for (int q = p + 1; q < k; q++) {
                const double apq = S[p * k + q];
                if (apq == 0.0)
                    continue;
                const double theta = (S[q * k + q] - S[p * k + p]) / (2.0 * apq);
                const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
                const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
                for (int i = 0; i < k; i++) {
                    const double a = S[i * k + p], b = S[i * k + q];
                    S[i * k + p] = c * a - s * b, S[i * k + q] = s * a + c * b;
                }
                for (int i = 0; i < k; i++) {
                    const double a = S[p * k + i], b = S[q * k + i];
                    S[p * k + i] = c * a - s * b, S[q * k + i] = s * a + c * b;
                }
                for (int i = 0; i < k; i++) {
                    const double a = U[i * k + p], b = U[i * k + q];
                    U[i * k + p] = c * a - s * b, U[i * k + q] = s * a + c * b;
                }
            }
    }
}

#endif
