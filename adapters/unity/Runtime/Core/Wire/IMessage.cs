namespace Pacinian.Wire
{
    /// <summary>A message, or a part of one, that a client sends.</summary>
    public interface IMessage
    {
        /// <summary>Writes all fields, in their order.</summary>
        void Write(Writer w);
    }
}
