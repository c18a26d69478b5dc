using Pacinian.Wire;

namespace Pacinian
{
    /// <summary>Finds objects that the server would reject. The server rejects a whole message because of one wrong object.</summary>
    public static class ObjectValidation
    {
        private const int Largest = Protocol.MaxCommandBytes - 1024; // [bytes] of one object; the rest is for other fields
        private const int LongestName = 64; // characters

        /// <summary>
        /// Returns what is wrong with an object; "" if nothing is. Does not know the limits in the server's own
        /// settings.
        /// </summary>
        public static string Problem(HapticObject item)
        {
            Writer writer = new Writer(4096);
            item.Write(writer);
            Refusal why;
            return Find("object", item, writer, new Reader(), out why)
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

        /// <summary>Returns whether an object is wrong, and why. written: its bytes. reader: used to decode them.</summary>
        internal static bool Find(string name, HapticObject item, Writer written, Reader reader, out Refusal why)
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
            return why.Message.Length > 0;
        }
    }
}
