using System;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics
{
    /// <summary>Converts audio to an envelope: mono, at a rate that suffices for skin.</summary>
    internal static class AudioWave
    {
        private const int Fast = 8000; // [Hz]; skin feels nothing above 1 kHz

        /// <summary>Returns null and the reason if there are no samples. If a clip is too long, cuts it and says so.</summary>
        public static Wave Of(AudioClip clip, out string problem)
        {
            float[] data = new float[clip.samples * clip.channels];
            if (!clip.GetData(data, 0))
            {
                problem = "its clip cannot be read: set Load Type to Decompress On Load";
                return null;
            }
            return Of(data, clip.frequency, clip.channels, out problem);
        }

        /// <summary>Does the same for interleaved samples. rate: of each channel [Hz].</summary>
        public static Wave Of(float[] data, float rate, int channels, out string problem)
        {
            problem = data.Length == 0 ? "has no clip and no samples" : "";
            if (data.Length == 0)
            {
                return null;
            }
            int group = Math.Max(1, (int)(rate / Fast)), step = group * channels;
            int count = Math.Max(1, data.Length / step);
            if (count > Protocol.MaxValues)
            {
                count = Protocol.MaxValues;
                problem = "its wave is cut after " + (int)(count * group / rate) + " s";
            }
            Wave made = new Wave { Rate = (double)rate / group };
            made.Samples.Reserve(4 * count);
            for (int i = 0; i < count; i++)
            {
                made.Samples.Add(Mean(data, i * step, step));
            }
            return made;
        }

        private static double Mean(float[] data, int start, int count)
        {
            double sum = 0.0;
            int end = Math.Min(start + count, data.Length);
            for (int i = start; i < end; i++)
            {
                sum += data[i];
            }
            return Math.Max(-1.0, Math.Min(1.0, sum / (end - start)));
        }
    }
}
