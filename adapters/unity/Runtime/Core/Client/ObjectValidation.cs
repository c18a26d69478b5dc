using System;
using System.Globalization;
using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>
    /// Finds objects that the server would reject. For most of these reasons, the server would reject the whole message,
    /// with all other objects in it. Not checked: whether a curve has a length, a mesh is closed and so on; such an object
    /// alone is left out.
    /// </summary>
    public static class ObjectValidation
    {
        private const int Largest = Protocol.MaxCommandBytes - 1024; // [bytes] of one object; the rest is for other fields
        private const int LongestName = 64; // characters

        /// <summary>Returns what is wrong with an object, whatever the server's settings; "" if nothing is.</summary>
        public static string Problem(HapticObject item)
        {
            Writer writer = new Writer(4096);
            item.Write(writer);
            Refusal why;
            return Find("object", item, writer, new Reader(), double.PositiveInfinity, out why)
                ? why.Message + (why.Path == "$.objects[object]" ? "" : " (" + why.Path.Substring("$.objects[object].".Length) + ")")
                : "";
        }

        /// <summary>Returns whether a name has 1 to 64 characters (code points), and no half of a surrogate pair.</summary>
        internal static bool IsName(string name)
        {
            int characters = 0;
            for (int i = 0; name != null && i < name.Length; i++)
            {
                characters++;
                if (char.IsSurrogate(name[i]) && !char.IsSurrogatePair(name, i++))
                {
                    return false;
                }
            }
            return characters > 0 && characters <= LongestName;
        }

        /// <summary>
        /// Returns whether an object is wrong, and why. written: its bytes. reader: used to decode them. most: the highest
        /// radiation pressure that the server allows [Pa].
        /// </summary>
        internal static bool Find(string name, HapticObject item, Writer written, Reader reader, double most, out Refusal why)
        {
            string path = "$.objects[" + name + "]";
            why = new Refusal { Code = "argument", Path = path, Message = "", Advice = "" };
            HapticObject read = null;
            reader.Start(written.Data, 0, written.Count);
            if (!IsName(name))
            {
                why.Message = "must have a name of 1 to " + LongestName + " characters, without half an UTF-16 pair";
            }
            else if (item.RadiationPressure.HasValue == item.Force.HasValue)
            {
                why.Message = "must have a radiation pressure or a force, and not both";
            }
            else if (item.RadiationPressure > most)
            {
                why.Code = "limit";
                why.Message = string.Format(
                    CultureInfo.InvariantCulture, "makes a radiation pressure of {0:G4} Pa: keep to {1} Pa", item.RadiationPressure, most);
                why.Path = path + ".radiation_pressure";
            }
            else if (written.Count > Largest)
            {
                why.Code = "limit";
                why.Message = "is " + written.Count + " bytes: keep to " + Largest;
                why.Advice = "use fewer points, faces or values";
            }
            else if (!Unions.Read(reader, ref read))
            {
                why.Message = reader.Problem;
                why.Path = path + reader.Path.Substring(1);
            }
            else
            {
                string flaw;
                why.Message = FindFlaw(item.Envelope, out flaw) ?? FindFlaw(item.Technique as STM, out flaw)
                    ?? FindFlaw(PoseOf(item), out flaw) ?? "";
                why.Path = path + flaw;
            }
            return why.Message.Length > 0;
        }

        /// <summary>
        /// Returns what is wrong although each field is in its range; null if nothing is. path: from the object on.
        /// </summary>
        private static string FindFlaw(IEnvelope envelope, out string path)
        {
            if (envelope is Pulse pulse)
            {
                path = pulse.Rise > 0.5 * pulse.Width ? ".envelope.rise" : ".envelope.period";
                return pulse.Rise > 0.5 * pulse.Width ? "must be at most half of the width"
                    : pulse.Period < pulse.Width ? "must be at least the width"
                    : FindFlaw(pulse.Low, pulse.High, out path);
            }
            if (envelope is Noise noise)
            {
                path = ".envelope.low_frequency";
                return noise.LowFrequency > 0.99 * noise.HighFrequency ? "must be at least 1 % below `high_frequency`"
                    : FindFlaw(noise.Low, noise.High, out path);
            }
            return envelope is Sine sine ? FindFlaw(sine.Low, sine.High, out path)
                : envelope is Square square ? FindFlaw(square.Low, square.High, out path)
                : FindFlaw(0.0, 0.0, out path);
        }

        private static string FindFlaw(double low, double high, out string path)
        {
            path = ".envelope.high";
            return high < low ? "must be at least `low`" : null;
        }

        private static string FindFlaw(STM technique, out string path)
        {
            path = ".technique.dwell";
            double? period = 1.0 / technique?.Frequency;
            return technique?.Dwell < period / 10000.0 || technique?.Dwell > period
                ? "must be from 1/10000 of the period, 1 / `frequency`, to the period" : null;
        }

        private static string FindFlaw(HapticPose pose, out string path)
        {
            path = ".pose.rotation";
            if (pose == null)
            {
                return null;
            }
            Quat turn = pose.Rotation;
            double length = Math.Sqrt(turn.X * turn.X + turn.Y * turn.Y + turn.Z * turn.Z + turn.W * turn.W);
            return Math.Abs(length - 1.0) > 0.01 ? "must be a quaternion of length 1" : null;
        }

        private static HapticPose PoseOf(HapticObject item)
        {
            return (item as HapticPath)?.Pose ?? (item as Particles)?.Pose ?? (item as Surface)?.Pose ?? (item as Volume)?.Pose;
        }
    }
}
