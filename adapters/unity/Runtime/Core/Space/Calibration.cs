using System;

namespace Pacinian
{
    /// <summary>The pose of the array in the tracked world, from known points of the array that a tracked finger touched.</summary>
    public struct Calibration
    {
        private const double LeastSpread = 1e-3; // [m] smallest spread of distinct points
        private const double LeastGap = 1e-3; // relative to the largest eigenvalue: points 40 times longer than wide

        /// <summary>The array's frame in the tracked world, both right-handed, in metres.</summary>
        public Rigid Origin;

        /// <summary>Root mean square distance between known and touched points [m].</summary>
        public double Residual;

        /// <summary>The largest of these distances [m].</summary>
        public double Worst;

        /// <summary>
        /// Fits the rigid transform, never a reflection, that moves the known points (array's frame) closest to the
        /// touched points (tracked world), in the same order [m]. Returns false and what to do if there are fewer than
        /// three points, or if they do not determine the rotation. Horn, J. Opt. Soc. Am. A 4, 629 (1987).
        /// </summary>
        public static bool Fit(Vec3[] known, Vec3[] touched, out Calibration made, out string problem)
        {
            made = new Calibration { Origin = Rigid.Identity };
            problem = known.Length < 3 || touched.Length != known.Length ? "touch 3 or more known points, each once"
                : !Finite(known) || !Finite(touched) ? "a point is not finite: was the tracker lost?" : "";
            if (problem.Length > 0)
            {
                return false;
            }
            Vec3 middle = Mean(known), centre = Mean(touched);
            double[,] N = Horn(known, middle, touched, centre);
            double[,] V = Symmetric.Diagonalise(N);
            int best = 0, next = 1;
            for (int i = 1; i < 4; i++)
            {
                next = N[i, i] > N[best, best] ? best : i > 1 && N[i, i] > N[next, next] ? i : next;
                best = N[i, i] > N[best, best] ? i : best;
            }
            double largest = N[best, best];
            if (largest < LeastSpread * LeastSpread || largest - N[next, next] < LeastGap * largest)
            {
                problem = "the points lie about on a line, or in one place: touch others farther apart";
                return false;
            }
            Quat rotation = new Quat(V[1, best], V[2, best], V[3, best], V[0, best]).Normalised;
            made.Origin = new Rigid(centre - rotation.Turn(middle), rotation);
            made.Measure(known, touched);
            return true;
        }

        private void Measure(Vec3[] known, Vec3[] touched)
        {
            double sum = 0.0;
            for (int i = 0; i < known.Length; i++)
            {
                double distance = (Origin.Point(known[i]) - touched[i]).Length;
                Worst = Math.Max(Worst, distance);
                sum += distance * distance;
            }
            Residual = Math.Sqrt(sum / known.Length);
        }

        /// <summary>Returns the matrix whose eigenvector of the largest eigenvalue is the rotation w, x, y, z.</summary>
        private static double[,] Horn(Vec3[] from, Vec3 middle, Vec3[] to, Vec3 centre)
        {
            double[,] N = new double[4, 4];
            for (int i = 0; i < from.Length; i++)
            {
                Vec3 a = from[i] - middle, b = to[i] - centre, c = Vec3.Cross(a, b);
                N[0, 0] += Vec3.Dot(a, b);
                N[1, 1] += a.X * b.X - a.Y * b.Y - a.Z * b.Z;
                N[2, 2] += a.Y * b.Y - a.X * b.X - a.Z * b.Z;
                N[3, 3] += a.Z * b.Z - a.X * b.X - a.Y * b.Y;
                N[1, 0] = N[0, 1] += c.X;
                N[2, 0] = N[0, 2] += c.Y;
                N[3, 0] = N[0, 3] += c.Z;
                N[2, 1] = N[1, 2] += a.X * b.Y + a.Y * b.X;
                N[3, 1] = N[1, 3] += a.Z * b.X + a.X * b.Z;
                N[3, 2] = N[2, 3] += a.Y * b.Z + a.Z * b.Y;
            }
            return N;
        }

        private static bool Finite(Vec3[] points)
        {
            foreach (Vec3 point in points)
            {
                if (!(point.Length < double.PositiveInfinity))
                {
                    return false;
                }
            }
            return true;
        }

        private static Vec3 Mean(Vec3[] points)
        {
            Vec3 sum = new Vec3();
            foreach (Vec3 point in points)
            {
                sum += point;
            }
            return (1.0 / points.Length) * sum;
        }
    }
}
