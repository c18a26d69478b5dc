using System;
using Pacinian.Wire;

/// <summary>Decodes messages of all sockets into reused objects, and writes them again.</summary>
internal sealed class VectorsDecoder
{
    private readonly Reader _reader = new Reader();
    private readonly Writer _writer = new Writer();
    private Command _command;
    private IControl _control;
    private IReply _reply;
    private IState _state;

    /// <summary>Returns bytes from hexadecimal.</summary>
    public static byte[] Bytes(string digits)
    {
        byte[] made = new byte[digits.Length / 2];
        for (int i = 0; i < made.Length; i++)
        {
            made[i] = Convert.ToByte(digits.Substring(2 * i, 2), 16);
        }
        return made;
    }

    /// <summary>Returns "valid" and the re-encoded bytes, or "refused" and the path of the error.</summary>
    public string Decode(string socket, byte[] data)
    {
        IMessage message = Read(socket, data);
        if (message == null)
        {
            return "refused " + _reader.Path + (_reader.Problem.Length == 0 ? " without a problem" : "");
        }
        _writer.Clear();
        message.Write(_writer);
        return "valid " + BitConverter.ToString(_writer.Data, 0, _writer.Count).Replace("-", "").ToLowerInvariant();
    }

    /// <summary>Returns the decoded message; null if it was rejected.</summary>
    public IMessage Read(string socket, byte[] data)
    {
        switch (socket)
        {
            case "command": return Protocol.ReadCommand(_reader, data, 0, data.Length, ref _command) ? _command : null;
            case "control": return Protocol.ReadControl(_reader, data, 0, data.Length, ref _control) ? _control : null;
            case "reply": return Protocol.ReadReply(_reader, data, 0, data.Length, ref _reply) ? _reply : null;
            default: return Protocol.ReadState(_reader, data, 0, data.Length, ref _state) ? _state : null;
        }
    }
}
