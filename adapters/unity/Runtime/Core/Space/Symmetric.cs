using System;

namespace Pacinian
{
    /// <summary>Computes eigenvalues of small symmetric matrices with Jacobi rotations.</summary>
    internal static class Symmetric
    {
        private const int Sweeps = 50;

        /// <summary>Makes A (n, n) diagonal, with the eigenvalues. Returns the eigenvectors as columns, in no order.</summary>
        public static double[,] Diagonalise(double[,] A)
        {
            int n = A.GetLength(0);
            double[,] V = new double[n, n];
            for (int i = 0; i < n; i++)
            {
                V[i, i] = 1.0;
            }
            for (int sweep = 0; sweep < Sweeps; sweep++)
            {
                for (int p = 0; p < n; p++)
                {
                    for (int q = p + 1; q < n; q++)
                    {
                        Annul(A, V, n, p, q);
                    }
                }
            }
            return V;
        }

        private static void Annul(double[,] A, double[,] V, int n, int p, int q)
        {
            if (A[p, q] == 0.0)
            {
                return;
            }
            double ratio = (A[q, q] - A[p, p]) / (2.0 * A[p, q]);
            double t = (ratio < 0.0 ? -1.0 : 1.0) / (Math.Abs(ratio) + Math.Sqrt(1.0 + ratio * ratio));
            double c = 1.0 / Math.Sqrt(1.0 + t * t), s = t * c;
            for (int k = 0; k < n; k++)
            {
                Turn(ref A[k, p], ref A[k, q], c, s);
                Turn(ref V[k, p], ref V[k, q], c, s);
            }
            for (int k = 0; k < n; k++)
            {
                Turn(ref A[p, k], ref A[q, k], c, s);
            }
            A[p, q] = A[q, p] = 0.0;
        }

        private static void Turn(ref double a, ref double b, double c, double s)
        {
            double old = a;
            a = c * old - s * b;
            b = s * old + c * b;
        }
    }
}
