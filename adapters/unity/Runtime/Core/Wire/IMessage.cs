namespace Pacinian.Wire
{
    /// <summary>A message that a client sends, or a part of one.</summary>
    public interface IMessage
    {
        /// <summary>Writes all fields in order.</summary>
        void Write(Writer w);
    }
}
