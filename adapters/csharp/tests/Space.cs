using System;
using System.Collections.Generic;
using System.Globalization;
using Pacinian;
using Pacinian.Wire;

/// <summary>Reads lines with an operation and numbers, and writes the resulting numbers.</summary>
internal static class Space
{
    private static double[] _given;
    private static int _at;

    private static void Main()
    {
        for (string line = Console.ReadLine(); line != null; line = Console.ReadLine())
        {
            string[] words = line.Split(' ');
            _given = new double[words.Length - 1];
            _at = 0;
            for (int i = 0; i < _given.Length; i++)
            {
                _given[i] = double.Parse(words[i + 1], CultureInfo.InvariantCulture);
            }
            Console.WriteLine(string.Join(" ", Array.ConvertAll(Done(words[0]), Said)));
        }
    }

    private static double[] Done(string operation)
    {
        switch (operation)
        {
            case "place": return Of(UnitySpace.Swap(Vec()));
            case "angular": return Of(UnitySpace.SwapAngular(Vec()));
            case "rotation": return Of(UnitySpace.Swap(Rotation()));
            case "frame": return Of(UnitySpace.Swap(Frame()));
            case "turn": return Of(Rotation().Turn(Vec()));
            case "product": return Of(Rotation() * Rotation());
            case "normalised": return Of(Rotation().Normalised);
            case "point": return Of(Frame().Point(Vec()));
            case "back": return Of(Frame().Inverse.Point(Vec()));
            case "direction": return Of(Frame().Inverse.Direction(Vec()));
            case "openleft": return Open(HandFrameSide.Left);
            case "openright": return Open(HandFrameSide.Right);
            case "chain": return Of(Frame() * Frame());
            default: return Fitted();
        }
    }

    /// <summary>Returns joints and radii of an open hand whose palm has a given pose.</summary>
    private static double[] Open(HandFrameSide side)
    {
        HandFrame frame = new HandFrame();
        OpenHand.Write(frame, side, Frame());
        double[] made = new double[4 * OpenHand.Count];
        for (int i = 0; i < made.Length; i++)
        {
            made[i] = i < frame.Joints.Numbers ? frame.Joints.Single(i) : frame.Radii.Single(i - frame.Joints.Numbers);
        }
        return made;
    }

    private static double[] Fitted()
    {
        int count = _given.Length / 6;
        Vec3[] known = new Vec3[count], touched = new Vec3[count];
        for (int i = 0; i < count; i++)
        {
            known[i] = Vec();
            touched[i] = Vec();
        }
        Calibration made;
        string problem;
        if (!Calibration.Fit(known, touched, out made, out problem))
        {
            return problem.Length == 0 ? new double[0] : Array.ConvertAll(new double[9], zero => double.NaN);
        }
        List<double> numbers = new List<double>(Of(made.Origin));
        numbers.Add(made.Residual);
        numbers.Add(made.Worst);
        return numbers.ToArray();
    }

    private static double Next()
    {
        return _given[_at++];
    }

    private static Vec3 Vec()
    {
        return new Vec3(Next(), Next(), Next());
    }

    private static Quat Rotation()
    {
        return new Quat(Next(), Next(), Next(), Next());
    }

    private static Rigid Frame()
    {
        return new Rigid(Vec(), Rotation());
    }

    private static double[] Of(Vec3 v)
    {
        return new[] { v.X, v.Y, v.Z };
    }

    private static double[] Of(Quat q)
    {
        return new[] { q.X, q.Y, q.Z, q.W };
    }

    private static double[] Of(Rigid frame)
    {
        return new[]
        {
            frame.Position.X, frame.Position.Y, frame.Position.Z,
            frame.Rotation.X, frame.Rotation.Y, frame.Rotation.Z, frame.Rotation.W,
        };
    }

    private static string Said(double value)
    {
        return value.ToString("R", CultureInfo.InvariantCulture);
    }
}
