namespace Pacinian.Wire
{
    /// <summary>A message, or a part of one.</summary>
    public interface IMessage
    {
        /// <summary>Writes all fields, in their order.</summary>
        void Write(Writer w);

        /// <summary>Reads it; what is not there takes its default. False: it is not valid, and is left half read.</summary>
        bool Read(Reader r);
    }
}
