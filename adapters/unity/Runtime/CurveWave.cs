using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Converts a curve to an envelope, sampled finely enough for skin.</summary>
    internal static class CurveWave
    {
        private const double Fast = 2000.0; // [Hz]; lower if the curve is long

        /// <summary>
        /// Samples the curve from time 0 to its last key, clamped to 0..1. Returns null and the reason if the curve has
        /// no length.
        /// </summary>
        public static Wave Of(AnimationCurve curve, out string problem)
        {
            int keys = curve.length;
            double end = keys == 0 ? 0.0 : curve[keys - 1].time;
            problem = end > 0.0 ? "" : "its curve has no key after 0 s";
            if (end <= 0.0)
            {
                return null;
            }
            double rate = Math.Max(1.0, Math.Min(Fast, Protocol.MaxValues / end));
            int count = Math.Max(1, Math.Min((int)Math.Round(end * rate), Protocol.MaxValues));
            Wave made = new Wave { Rate = rate };
            made.Samples.Reserve(4 * count);
            for (int i = 0; i < count; i++)
            {
                made.Samples.Add(2.0 * Mathf.Clamp01(curve.Evaluate((float)(i / rate))) - 1.0);
            }
            return made;
        }
    }
}
