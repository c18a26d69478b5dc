using Pacinian.Wire;

namespace Pacinian.Haptics
{
    /// <summary>What the server would refuse is found here: one bad object would take others of its message with it.</summary>
    internal static class Checking
    {
        /// <summary>What is wrong with an object; "" if nothing is. blank: another of its kind, which is read into.</summary>
        public static string Problem(Felt felt, Felt blank)
        {
            Writer writer = new Writer(4096);
            felt.Write(writer);
            if (writer.Count > Protocol.MaxCommandBytes - 1024)
            {
                return "is too large: keep to " + Protocol.MaxVertices / 2 + " vertices";
            }
            Reader reader = new Reader();
            reader.Start(writer.Data, 0, writer.Count);
            return blank.Read(reader) ? "" : reader.Problem + " (" + reader.Path + ")";
        }
    }
}
